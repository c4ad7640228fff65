# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head: its mesh, regions, landmarks and identity modes."""
