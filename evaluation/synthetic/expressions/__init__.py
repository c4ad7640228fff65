# SPDX-License-Identifier: GPL-3.0-or-later
"""Nine expressions by many people: the clips of `mimetic evaluate --set full`."""
