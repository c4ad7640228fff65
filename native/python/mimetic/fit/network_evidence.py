# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes and mouth of a picture by the networks that have seen real faces, for the fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.locate.feature_networks import ANCHORS, installed_networks, network_features


def with_networks(
    image: NDArray[np.uint8],
    features: _core.FaceFeatures,
    camera: _core.Camera,
    model: _core.FaceModel,
    estimate: _core.FaceEstimate,
) -> _core.FaceFeatures:
    """The features, at eyes and mouth by the networks where they are installed.

    image: (H, W, 3) uint8 RGB; estimate: of the head in this picture alone; it places the crops.
    """
    networks = installed_networks()
    if networks is None:
        return features
    names = list(model.landmark_names)
    anchors = model.landmarks(estimate.identity)[[names.index(name) for name in ANCHORS]]
    try:
        crops = _core.feature_crops(camera, estimate.camera_from_head[0], anchors)
        evidence = network_features(networks, image, crops)
    except _core.InvalidInput:  # a head beside the picture, or behind the camera: not yet a face
        return features
    return _core.with_network_features(features, evidence)
