// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/camera.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <vector>

namespace mimetic {

/// Where places of a surface are as a camera sees it.
struct ShownPlaces {
    Points points;              ///< P x 3, metres, camera frame
    Points2 pixels;             ///< P x 2; not a number behind the camera
    std::vector<bool> visible;  ///< P: in the picture, facing the camera, not occluded
};

/// vertices_in_camera: V x 3, metres; faces: F x 4. Throws InvalidInput on an index out of range.
ShownPlaces show_places(const Camera& camera, PointsIn vertices_in_camera, QuadsIn faces,
                        const SkinPlaces& places);

}  // namespace mimetic
