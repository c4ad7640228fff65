# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage: decoding by a process of its own, frame rates, cuts."""
