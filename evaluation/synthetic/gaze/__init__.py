# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips of people who look about: those of `mimetic evaluate gaze`."""
