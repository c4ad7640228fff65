# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces moved by other people's muscles in a skin that turns far: truth by non-linear simulation.

The insertions are 3 mm off and the skin is held twice as stiffly as the estimator assumes; its
strains are measured in axes that turn with it (CorotationalSkin), so that what is seen is in no
linear basis.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from mimetic.muscles.anatomy import AnatomyPerturbation, attach
from mimetic.muscles.motion import load_skin
from mimetic.template.face_template import FaceTemplate

from ..motion import control_values
from ..recipes import Recipe
from ..scene import Motion

INSERTION_MM, STIFFNESS_FACTOR = 3.0, 2.0
# Every third frame is solved; what it differs by from the linear answer is smooth in between, and
# grows with the load's square: under this load it is a micrometre.
SOLVED_STEP = 3
LEAST_LOAD = 0.05
MOST_ITERATIONS = 3000  # where a pucker buckles the skin, hundreds are needed
TOLERANCE = 5e-4  # of the force that is left: some hundredths of a millimetre


def simulated_motion(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> Motion:
    """Controls over time and the displacements they cause; neutral V x 3, metres."""
    other = AnatomyPerturbation(INSERTION_MM, STIFFNESS_FACTOR, recipe.seed)
    anatomy = attach(neutral, template, perturbation=other)
    names = [*anatomy.muscle_names, *anatomy.articulator_names]
    times = np.arange(recipe.num_frames) / recipe.fps
    values = control_values(recipe.phases, names, times)
    modes = np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes])
    moved = np.tensordot(values, modes, axes=1)
    moved += _corrections(recipe, template, neutral, values, names)
    groups = np.concatenate([anatomy.groups, np.zeros(len(anatomy.articulator_names), int)])
    return Motion(names, values, groups, moved)


def _corrections(
    recipe: Recipe,
    template: FaceTemplate,
    neutral: np.ndarray,
    values: np.ndarray,
    names: list[str],
) -> np.ndarray:
    """What large rotations change (N,V,3), metres."""
    other = AnatomyPerturbation(INSERTION_MM, STIFFNESS_FACTOR, recipe.seed)
    loaded = load_skin(neutral, template, perturbation=other)
    loads = values[:, [names.index(name) for name in loaded.names]]
    solver = loaded.corotational()
    count = len(values)
    found = np.zeros((count, *neutral.shape))
    at = np.unique([*range(0, count, SOLVED_STEP), count - 1])
    for i in at:
        if loads[i].max() < LEAST_LOAD:
            continue
        forces = np.tensordot(loads[i], loaded.forces, axes=1).ravel()
        solution = solver.solve(forces, MOST_ITERATIONS, TOLERANCE)
        if not solution.converged:
            raise ValueError(f"{recipe.name}: the skin found no rest in frame {i + 1}")
        linear = loaded.skin.model.solve(forces[:, None])[:, 0]
        response = np.zeros((1, len(loaded.skin.free), 3))
        response[0, loaded.skin.free] = (solution.unknowns - linear).reshape(-1, 3)
        found[i] = loaded.skin.spread(response)[0]
    for before, after in pairwise(at):
        for i in range(before + 1, after):
            share = (i - before) / (after - before)
            found[i] = (1 - share) * found[before] + share * found[after]
    return found
