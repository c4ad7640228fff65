# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips of people who speak, wink and blink: those of `mimetic evaluate speech`."""
