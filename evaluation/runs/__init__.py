# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of accuracy beside peers and floors: what `mimetic evaluate` runs in a checkout."""
