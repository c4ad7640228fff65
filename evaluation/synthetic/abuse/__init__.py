# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage that real cameras and editors hand out: covered faces, cuts, dissolves, dark seconds."""
