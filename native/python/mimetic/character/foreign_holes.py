# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes in the skin of a foreign head where a face has none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.muscles.articulators import eye_frames
from mimetic.skin.mesh import SkinMesh

AROUND_EYE = 0.030  # m at the template's size, from its centre
AROUND_MOUTH = 0.040
AROUND_NOSE = 0.025  # nostrils


def hole_notes(
    skin: ForeignSkin, template_mesh: SkinMesh, free: NDArray[np.bool_]
) -> tuple[str, ...]:
    """A note, naming a face of the caller's, for each hole in free skin (N) that is not an eye's,
    the mouth's, a nostril's or the end of the mesh. template_mesh: the registered template."""
    places = [(frame.centre, AROUND_EYE) for frame in eye_frames(template_mesh)]
    inner = [skin.landmarks[f"lip_{lip}_inner"] for lip in ("upper", "lower")]
    places += [(np.mean(inner, axis=0), AROUND_MOUTH), (skin.landmarks["nose_tip"], AROUND_NOSE)]
    middles, reaches = zip(*places, strict=True)
    beside = _core.find_holes(skin.mesh, free, np.array(middles), np.array(reaches))
    return tuple(
        f"there is a hole in the skin beside face {face}: it was left open" for face in beside
    )
