# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character's own controls: shape keys and bones that its maker gave it."""
