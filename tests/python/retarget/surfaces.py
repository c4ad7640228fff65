# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head as a character that has controls of its own: the face units, named at will."""

import dataclasses

import numpy as np
from mimetic.character.canonical_head import make_head
from mimetic.performance.document import Performance
from mimetic.retarget.controls import ControlSurface
from mimetic.template.face_template import load_template


def make_surface(names=None, has_muscles=True) -> ControlSurface:
    """names: of the 52 controls, as the units' own if None."""
    head, template = make_head(), load_template()
    shapes = head.shapes if has_muscles else []
    return ControlSurface(
        points=head.vertices,
        starts=np.arange(0, head.faces.size, 4),
        corners=head.faces.reshape(-1),
        control_names=list(names or template.unit_names),
        controls=np.asarray(template.unit_modes, dtype=np.float64),
        control_range=np.tile([0.0, 1.0], (52, 1)),
        source_names=[shape.name for shape in shapes],
        sources=np.array([shape.offsets for shape in shapes]).reshape(
            len(shapes), len(head.vertices), 3
        ),
        source_range=np.array([(s.lowest, s.highest) for s in shapes]).reshape(-1, 2),
    )


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


def renamed(surface: ControlSurface, prefix: str = "Key ") -> ControlSurface:
    names = [f"{prefix}{i:02d}" for i in range(len(surface.control_names))]
    return dataclasses.replace(surface, control_names=names)
