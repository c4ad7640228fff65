# SPDX-License-Identifier: GPL-3.0-or-later
"""Skins that are factored in two threads at once are those of one thread, to the bit."""

import numpy as np
from mimetic.fit.line_modes import line_modes
from mimetic.fit.residual_shape import residual_modes
from mimetic.shared.parallel import both
from mimetic.template.face_template import load_template


def test_factors_do_not_depend_on_what_other_threads_factor():
    template = load_template()
    plain = residual_modes.__wrapped__, line_modes.__wrapped__  # computed anew each time
    alone = [modes(template) for modes in plain]
    for _ in range(3):
        together = both(lambda: plain[0](template), lambda: plain[1](template))
        for one, other in zip(together, alone, strict=True):
            np.testing.assert_array_equal(one, other)
