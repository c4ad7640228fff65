# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground that every stage stands on: arrays in files, rotations, pictures, installed data."""
