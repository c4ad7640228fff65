# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips whose muscles fire at known moments, for `mimetic evaluate timing`."""
