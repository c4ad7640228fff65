# SPDX-License-Identifier: GPL-3.0-or-later
"""The correlations of muscles that the priors are made of."""

import numpy as np
from mimetic.muscles.anatomy import muscle_names
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.co_contraction import SIDES_TOGETHER, correlation
from mimetic.muscles.sides import mirrored_name

NAMES = [*muscle_names(), *ARTICULATORS]


def test_it_is_a_correlation_with_a_margin():
    together = correlation(NAMES)
    assert np.array_equal(together, together.T)
    assert np.array_equal(np.diag(together), np.ones(len(NAMES)))
    assert np.linalg.eigvalsh(together)[0] > 0.01


def test_both_sides_are_alike():
    together = correlation(NAMES)
    other = np.array([NAMES.index(mirrored_name(name)) for name in NAMES])
    assert np.array_equal(together, together[np.ix_(other, other)])


def test_muscles_of_the_mouths_corner_go_together_and_lids_in_pairs():
    together = correlation(NAMES)

    def between(first: str, second: str) -> float:
        return together[NAMES.index(first), NAMES.index(second)]

    assert between("zygomaticus_major.L", "risorius.L") > 0.2
    assert between("frontalis_medial.L", "procerus.L") < 0.1
    assert between("lid_upper.L", "lid_upper.R") == SIDES_TOGETHER
    assert between("lid_upper.L", "risorius.L") == 0


def test_without_it_the_two_sides_alone_go_together():
    alone = correlation(NAMES, together=False)
    risorius = NAMES.index("risorius.L")
    assert np.flatnonzero(alone[risorius]).tolist() == [risorius, NAMES.index("risorius.R")]
    assert alone[risorius, NAMES.index("risorius.R")] == SIDES_TOGETHER
