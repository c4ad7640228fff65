# SPDX-License-Identifier: GPL-3.0-or-later
"""How bright a colour looks."""

import numpy as np

GREY = np.array([0.299, 0.587, 0.114])  # of red, green and blue, ITU-R BT.601
