# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws people with known landmarks, trains a cascade on them; ../train_landmarks runs it."""
