# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on a character's mesh: it turns about its own head's centre.

*Character* frame: as in `rig_motion`, from midway between the ears. Metres unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic._core import rotation_of
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.character.rig_motion import Channels, carried_channels, motion
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

Floats = NDArray[np.float64]


def object_from_character(
    points: ArrayLike, landmarks: Mapping[str, int | ArrayLike], metres_from_object: ArrayLike
) -> Floats:
    """4 x 4: where the head is in an object, and where it faces there, by its landmarks.

    points: V x 3, the object's frame; landmarks: name -> vertex, or place in metres;
    metres_from_object: 4 x 4, as it was for those places.
    """
    points = np.asarray(points, dtype=np.float64)
    matrix = np.asarray(metres_from_object, dtype=np.float64)
    places = [
        matrix[:3, :3] @ points[int(place)] + matrix[:3, 3] if place.ndim == 0 else place
        for place in (np.asarray(landmarks[name]) for name in REQUIRED)
    ]
    template = load_template()
    usual = template.vertices[[template.landmark(name) for name in REQUIRED]]
    return _core.object_from_character(usual, np.array(places, dtype=np.float64), matrix)


def head_channels(
    performance: Performance,
    world_from_character: ArrayLike,
    location: ArrayLike,
    rotation: ArrayLike,
    rotation_mode: str,
    units: float = 1.0,
) -> Channels:
    """Curves of an object without parent that move it as the actor's head moves from its rest.

    world_from_character: 4 x 4, where the object's head rests in the world; location: 3, rotation:
    3 x 3, the object's own now; units: of the world, per metre.
    """
    world = np.asarray(world_from_character, dtype=np.float64)
    axes = rotation_of(world[:3, :3], "head")
    # The object's origin goes where a rigid head takes it: it may lie at the feet
    pivot = (np.asarray(location, dtype=np.float64) - world[:3, 3]) @ axes / units
    head_motion = motion(performance, pivot=pivot)
    return carried_channels(head_motion, location, rotation, np.eye(4), axes, rotation_mode, units)
