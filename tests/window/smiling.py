# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance of real muscles for walks that need no footage."""

import numpy as np
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template


def smiling(num_frames: int) -> Performance:
    """Our own head smiling on one side more, twice, with jitter, as it turns."""
    template = load_template()
    anatomy = modes_of(attach_skin(template.vertices, template))
    t = np.arange(num_frames)
    event = np.clip(np.sin(2 * np.pi * t / 45), 0, 1) ** 2
    is_smile = np.array(
        [name.startswith(("zygomaticus", "frontalis")) for name in anatomy.muscle_names]
    )
    side = np.array([1.0 if name.endswith(".L") else 0.5 for name in anatomy.muscle_names])
    jitter = np.random.default_rng(4).normal(0, 0.03, (num_frames, len(side)))
    activations = np.clip(event[:, None] * (is_smile * side) + jitter * is_smile, 0, 1)
    pose = np.tile(np.diag([1.0, -1, -1, 1]), (num_frames, 1, 1))
    pose[:, 2, 3] = 0.6
    names = list(ARTICULATORS)
    values = np.zeros((num_frames, len(names)))
    values[:, names.index("jaw_open")] = 0.3 * event
    return Performance(
        frame=t + 1,
        fps=25.0,
        image_size=np.array([640, 480]),
        intrinsics=np.array([[700.0, 0, 319.5], [0, 700, 239.5], [0, 0, 1]]),
        head_pose=pose,
        head_pose_cov=np.tile(np.eye(6) * 1e-6, (num_frames, 1, 1)),
        muscles=list(anatomy.muscle_names),
        muscle_modes=anatomy.muscle_modes,
        groups=np.asarray(anatomy.groups),
        activations=activations,
        activations_std=np.full(activations.shape, 0.02),
        articulators=names,
        articulator_values=values,
        articulator_modes=anatomy.articulator_modes,
        neutral_vertices=template.vertices,
        faces=template.faces,
        quality=np.full(num_frames, 0.9),
    )
