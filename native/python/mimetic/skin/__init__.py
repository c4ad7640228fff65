# SPDX-License-Identifier: GPL-3.0-or-later
"""The skin as a mesh of shell elements, and checks of a mesh before it is taken for skin."""
