# SPDX-License-Identifier: GPL-3.0-or-later
"""Portraits at rest of people whose head is known to the vertex, for scoring the fit."""
