# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces driven live: cameras, the filter without a look ahead, takes, values sent elsewhere."""
