# SPDX-License-Identifier: GPL-3.0-or-later
"""A fitted head with its muscles, ready to be followed through footage."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.muscles import co_contraction
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.detail import Detail
from mimetic.solve.features import feature_inputs
from mimetic.solve.glasses import rims_before
from mimetic.template.face_template import FaceTemplate

# Hair, neck and ears move on their own or show no skin; mouth and sockets are seen only now and
# then. Lids are measured twice, by flow and by their own evidence: in a blink flow loses them,
# but at rest they are a tenth of the visible face.
UNMEASURED = ("scalp", "neck", "ear", "mouth_cavity", "eye_socket")
ACTIVATION_STD = 0.3
# How far articulators stray from rest; from the front a camera hardly sees the jaw's thrust.
ARTICULATOR_STD = {
    "jaw_open": 0.3,
    "jaw_side": 0.1,
    "jaw_thrust": 0.1,
    "lid_upper": 0.5,
    "lid_lower": 0.15,
    # Lips push each other off the slit: that force is there whenever they meet, so no sparse prior
    "oris_close_upper": 0.45,
    "oris_close_lower": 0.45,
    "lip_roll_upper": 0.2,
    "lip_roll_lower": 0.2,
}
# Of the chin's depth beside the eyes', metres: what one frontal picture leaves open
CHIN_DEPTH_STD = 6e-3
# How many times as fast as a skin muscle: a blink is shut in two frames
QUICKNESS = {"lid_upper": 8.0, "lid_lower": 4.0}


def measured_skin(
    neutral_vertices: NDArray[np.float64], template: FaceTemplate
) -> NDArray[np.float64]:
    """K x 3 of a head's vertices (V x 3), in their frame: those of skin that is measured."""
    return neutral_vertices[: template.num_skin_vertices][~template.in_region(*UNMEASURED)]


def face_motion(
    neutral_vertices: NDArray[np.float64],
    template: FaceTemplate,
    anatomy: Anatomy,
    detail: Detail | None = None,
    extent: NDArray[np.float64] | None = None,
    lowest: float = 0.0,
    neutral_depth_std: NDArray[np.float64] | None = None,
    together: bool = True,
) -> _core.FaceMotion:
    """The skin's motion: muscles, the articulators, then detail.

    neutral_vertices: V x 3, metres; detail: None for muscles and articulators alone; extent: M, the
    muscles' upper bounds, 1 without; lowest: their lower bound, and half of it the opened jaw's;
    neutral_depth_std: S, metres, what the depth of the neutral may be off by; together: whether
    muscles that act together in most people share what either may have done.
    """
    skin = template.num_skin_vertices
    modes, std = moving_modes(anatomy, skin)
    muscles = len(anatomy.muscle_names)
    names = [*anatomy.muscle_names, *anatomy.articulator_names]
    limits = np.vstack([np.tile([lowest, 1.0], (muscles, 1)), anatomy.articulator_limits])
    jaw = names.index("jaw_open")
    limits[jaw, 0] = min(limits[jaw, 0], lowest / 2)
    if extent is not None:
        limits[:muscles, 1] = extent
    return _core.FaceMotion(
        np.ascontiguousarray(neutral_vertices[:skin], dtype=np.float64),
        np.ascontiguousarray(modes, dtype=np.float64),
        muscles,
        limits[:, 0],
        limits[:, 1],
        std,
        None if detail is None else np.ascontiguousarray(detail.modes[:, :skin]),
        None if detail is None else detail.std,
        np.array([QUICKNESS.get(n.split(".")[0], 1.0) for n in names]),
        depth_std(names, modes, neutral_depth_std),
        co_contraction.correlation(names, together),
    )


def depth_std(
    names: list[str],
    modes: NDArray[np.float64],
    neutral_depth_std: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """How far a turned head's depth may look like a value's movement: the chin's like the jaw's.

    M, in units of the values at a turn of 45 degrees; modes: M x S x 3, metres; neutral_depth_std:
    S, metres, as the relief knows it, or None.
    """
    std = np.zeros(len(names))
    side = names.index("jaw_side")
    aside = np.abs(modes[side, :, 0])
    known = CHIN_DEPTH_STD
    if neutral_depth_std is not None:
        known = np.average(neutral_depth_std, weights=aside**2)
    std[side] = known / aside.max()
    return std


def moving_modes(
    anatomy: Anatomy, num_skin_vertices: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Modes of the skin by muscles, then articulators (M x S x 3, metres), and their priors (M)."""
    modes = np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes])
    std = [*np.full(len(anatomy.muscle_names), ACTIVATION_STD) / anatomy.extent]
    std += [ARTICULATOR_STD[name.split(".")[0]] for name in anatomy.articulator_names]
    return modes[:, :num_skin_vertices], np.array(std)


def make_tracker(
    image: NDArray[np.uint8],
    fit: FaceFit,
    template: FaceTemplate,
    anatomy: Anatomy,
    motion: _core.FaceMotion,
    options: _core.TrackerOptions | None = None,
) -> _core.FaceTracker:
    """A tracker that starts at the fit's frame.

    image: (H, W, 3) uint8, the footage's frame number `fit.frame`; motion: `face_motion` of the
    person. The skin behind the rims of glasses is not measured. Raises InvalidInput.
    """
    weights = (~template.in_region(*UNMEASURED)).astype(np.float64)
    return _core.FaceTracker(
        fit.camera,
        np.ascontiguousarray(template.skin_faces, dtype=np.int32),
        weights,
        motion,
        np.ascontiguousarray(image),
        np.asarray(fit.head_pose, dtype=np.float64),
        feature_inputs(fit, template, anatomy),
        options or _core.TrackerOptions(),
        rims=rims_before(image, fit, template),
    )
