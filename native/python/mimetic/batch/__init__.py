# SPDX-License-Identifier: GPL-3.0-or-later
"""Many clips, each by a process of its own: on this machine, or by an engine that a studio runs."""
