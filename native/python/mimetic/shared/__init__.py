# SPDX-License-Identifier: GPL-3.0-or-later
"""What every stage uses: arrays in files, rotations, pictures, installed data."""
