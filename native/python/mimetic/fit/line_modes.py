# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways in which a fitted head's lids and lips may still be off, as smooth local deformations.

Proportions and the residual warp are smooth over centimetres: a lid that runs higher, an eye that
is wider or a fuller lip takes its surroundings along with it, or stays where it is. Here a skin
that is held more firmly is pulled at the lines of lids and lips alone, so that what it does ends
near them. Lids slide on their eyeballs, which stay.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.residual_shape import held_skin
from mimetic.muscles.feature_lines import feature_lines
from mimetic.skin.mesh import canonical_skin
from mimetic.template.face_template import FaceTemplate

PULL_RADIUS = 0.003  # metres, s.d.
APART = 0.0025  # metres between the places that are pulled
PLACES = 60
ATTACHMENT = 4e5  # N/m^3: deformations reach about a centimetre
# Metres, root mean square over the lines, mirrored alike and opposed
SPREAD, ODD_SPREAD = 0.0010, 0.0005
LEAST_VARIANCE = 0.03  # of the largest mode's
STEEPEST = 0.8  # cosine to the front: nearer to its side an eyeball is not followed further back
ON_EYEBALL = 0.005  # metres from a lid's margin, s.d., within which skin slides on the eyeball


@lru_cache(maxsize=2)
def line_modes(template: FaceTemplate) -> NDArray[np.float64]:
    """M x V x 3 metres at one prior standard deviation; even modes under the mirror, then odd."""
    count = template.num_skin_vertices
    points = np.ascontiguousarray(template.vertices[:count])
    on_lines = sorted({v for line in feature_lines(template).values() for v in line})
    is_allowed = np.zeros(count, dtype=bool)
    is_allowed[on_lines] = points[on_lines, 0] > -1e-6
    corner = template.landmark("mouth_corner.L")
    is_allowed[corner] = True
    places = _core.spread_rows(points, [corner], is_allowed.tolist(), PLACES, APART)
    respond = held_skin(template, ATTACHMENT)
    modes = []
    for parity, spread in ((1, SPREAD), (-1, ODD_SPREAD)):
        pulls = _core.paired_pulls(points, places, np.ones(count, bool), PULL_RADIUS, parity)
        pulls = pulls[np.abs(pulls[..., 2]).max(axis=1) == 0]  # one camera hardly sees depth
        modes.append(_core.elastic_modes(pulls, respond(pulls), on_lines, spread, LEAST_VARIANCE))
    return _with_lashes(template, _on_eyeballs(template, np.concatenate(modes)))


def _on_eyeballs(template: FaceTemplate, modes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The modes with lids that slide on the eyeballs, where they go to seen from the front."""
    points = np.ascontiguousarray(template.vertices[: template.num_skin_vertices])
    lines = feature_lines(template)
    for side, centre in zip("LR", template.eye_centers, strict=True):
        margin = lines[f"lid_upper.{side}"] + lines[f"lid_lower.{side}"]
        modes = _core.sliding_on_eyeball(modes, points, margin, centre, ON_EYEBALL, STEEPEST)
    return modes


def _with_lashes(template: FaceTemplate, skin: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x V x 3 of N x S x 3: lashes go with their roots, eyeballs, teeth and tongue stay."""
    return _core.spread(skin, _core.followed_vertices(canonical_skin(template)))
