# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads that turn in a known way: the sequences of `mimetic evaluate head`."""
