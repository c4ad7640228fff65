# SPDX-License-Identifier: GPL-3.0-or-later
"""How those of a performance's notes begin by which lists of takes tell one from another."""

CALIBRATED = "calibrated to this person"
HEAD_ALONE = "head motion alone"
