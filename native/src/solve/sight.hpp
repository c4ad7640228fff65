// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cover.hpp"
#include "reference_views.hpp"

namespace mimetic {

/// Visibility of the skin under a hypothesis.
class Sight {
public:
    Sight(const TrackedFace& face, const Cover& cover) : face_(face), cover_(cover) {}

    /// Rasterises the depth at low resolution: occlusion hardly changes with the steps that follow.
    /// face_height: pixels.
    void draw(const ProjectedSurface& projected, const FaceState& state, double face_height);

    /// Visibility of each sample of a view, 0 to 1.
    std::vector<float> visible(const ReferenceView& view, const ProjectedSurface& projected,
                               const FaceState& state) const;

private:
    const TrackedFace& face_;
    const Cover& cover_;  // of the present frame
    Raster raster_;
    RasterGrid grid_;
};

}  // namespace mimetic
