# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a face and its features are in an image."""
