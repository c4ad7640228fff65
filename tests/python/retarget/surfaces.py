# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head as a character that has controls of its own: the face units, named at will."""

import dataclasses

import numpy as np
from mimetic.character.canonical_head import make_head
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


def renamed(surface: ControlSurface, prefix: str = "Key ") -> ControlSurface:
    names = [f"{prefix}{i:02d}" for i in range(len(surface.control_names))]
    return dataclasses.replace(surface, control_names=names)
