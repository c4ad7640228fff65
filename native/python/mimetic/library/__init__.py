# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions that are kept, mirrored and composed."""
