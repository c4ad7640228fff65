# SPDX-License-Identifier: GPL-3.0-or-later
"""When muscles fire, and how the face moves beside what FACS describes."""
