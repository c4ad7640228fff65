# SPDX-License-Identifier: GPL-3.0-or-later
"""A made-up performance of the canonical head by named muscles, jaw and lids."""

import numpy as np
from mimetic.character.canonical_head import make_head
from mimetic.performance.document import Performance


def make_acting(values: dict[str, np.ndarray]) -> Performance:
    """A still head whose muscles, jaw and lids have these values (N each); the others rest."""
    head = make_head()
    count = len(next(iter(values.values())))
    shapes = {shape.name: shape for shape in head.shapes}
    muscles = [shape.name for shape in head.shapes if shape.lowest == 0][:36]
    bones = [shape.name for shape in head.shapes[36:43]]
    assert set(values) <= {*muscles, *bones}

    def columns(names):
        return np.stack([values.get(name, np.zeros(count)) for name in names], axis=1)

    pose = np.diag([1.0, -1, -1, 1])
    pose[2, 3] = 0.6
    return Performance(
        frame=np.arange(1, count + 1),
        fps=25.0,
        image_size=np.array([400, 300]),
        intrinsics=np.array([[520.0, 0, 199.5], [0, 520, 149.5], [0, 0, 1]]),
        head_pose=np.tile(pose, (count, 1, 1)),
        head_pose_cov=np.tile(np.eye(6) * 1e-6, (count, 1, 1)),
        muscles=muscles,
        muscle_modes=np.stack([shapes[name].offsets for name in muscles]).astype(np.float32),
        groups=np.arange(36) % 7 + 1,
        activations=columns(muscles),
        activations_std=np.full((count, 36), 0.02),
        articulators=bones,
        articulator_values=columns(bones),
        articulator_modes=np.stack([shapes[name].offsets for name in bones]).astype(np.float32),
        neutral_vertices=head.vertices,
        faces=head.faces,
        quality=np.ones(count),
    )
