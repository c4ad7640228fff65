# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes and mouth of a picture by the networks that have seen real faces, for the fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.locate.feature_networks import (
    ANCHORS,
    both_eyes,
    eye_regressor,
    installed_networks,
    network_features,
)

# Probability of a face that the networks give where a head is. At least where there is one: on a
# test card that the finder takes for a face it is 6e-7. And that which a head has alone that is
# fitted with its lean: on 10 frames of five clips, 23 photographs and drawn people it is above
# .999999, where a head is fitted wrongly to the same pictures on their side or head .9995 at most.
LEAST_PRESENCE, SURE_PRESENCE = 0.02, 0.99999


def presence(
    image: NDArray[np.uint8],
    camera: _core.Camera,
    head_pose: NDArray[np.float64],
    anchors: NDArray[np.float64],
) -> float | None:
    """How likely the networks see a face where a head is; None where they are not installed.

    image: (H, W, 3) uint8 RGB; head_pose: (4, 4) camera_from_head; anchors: `feature_anchors`.
    """
    networks = installed_networks()
    if networks is None:
        return None
    try:
        face = _core.feature_crops(camera, head_pose, anchors).face
        return networks.mesh(image, face).presence
    except _core.InvalidInput:  # a head beside the picture
        return 0.0


def is_seen(
    image: NDArray[np.uint8],
    camera: _core.Camera,
    head_pose: NDArray[np.float64],
    anchors: NDArray[np.float64],
) -> bool:
    """Whether the networks see a face where a head is; True where they are not installed.

    Arguments as `presence` has them.
    """
    probability = presence(image, camera, head_pose, anchors)
    return probability is None or probability >= LEAST_PRESENCE


def with_networks(
    image: NDArray[np.uint8],
    features: _core.FaceFeatures,
    camera: _core.Camera,
    model: _core.FaceModel,
    estimate: _core.FaceEstimate,
) -> _core.FaceFeatures:
    """The features, at eyes and mouth by the networks; lids by our regressor where there are none.

    image: (H, W, 3) uint8 RGB; estimate: of the head in this picture alone; it places the crops.
    """
    names = list(model.landmark_names)
    anchors = model.landmarks(estimate.identity)[[names.index(name) for name in ANCHORS]]
    try:
        crops = _core.feature_crops(camera, estimate.camera_from_head[0], anchors)
        evidence = _seen(image, crops)
    except _core.InvalidInput:  # a head beside the picture, or behind the camera: not yet a face
        return features
    return _core.with_network_features(features, evidence)


def _seen(image: NDArray[np.uint8], crops: _core.FeatureCrops) -> _core.FaceFeatures:
    networks = installed_networks()
    if networks is not None:
        return network_features(networks, image, crops)
    return _core.eye_features(*both_eyes(eye_regressor(), image, crops))
