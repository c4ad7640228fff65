# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws people by the hundred and trains eigenspaces on them; ../train_eigenspaces runs it."""
