# SPDX-License-Identifier: GPL-3.0-or-later
"""Short clips that are at rest for a third of a second: those of `mimetic evaluate rest`."""
