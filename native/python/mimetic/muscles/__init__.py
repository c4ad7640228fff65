# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, jaw, lids and contact attached to a skin, and what each moves."""
