# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces driven live: taught looks, cameras, the filter, takes, values sent elsewhere."""
