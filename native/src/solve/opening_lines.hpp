// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/features.hpp>

#include "face_state.hpp"

namespace mimetic {

/// Where an opening's lines are compared: K places, on every line the same shares of its way, and a mouth's
/// two corners on its first.
struct LinePlace {
    int line;
    double along;  ///< -.5 at the first corner to .5 at the second
    bool meets;    ///< the line meets another where the opening is shut
};

/// Differences between a measured opening and the model at a state, across the opening alone: along a line
/// points are not distinguishable (aperture problem). In interpupillary distances.
struct OpeningOffsets {
    Eigen::VectorXd offsets;    ///< K: from the model to what was seen
    Eigen::MatrixXd by_values;  ///< K x M: how the model moves
    Eigen::MatrixXd by_detail;  ///< K x D: the same by detail, which is 0 at a state
    Eigen::VectorXd
        from_slit;          ///< K: of lines that meet, from the middle between them as it was seen; else 0
    double pixel = 0;       ///< one pixel
    double frontality = 1;  ///< cosine between the way the opening faces and the way to the camera
};

/// The lines of one opening on the limit surface.
class OpeningLines {
public:
    OpeningLines(const FaceSurface& surface, const FeatureOpening& opening);

    const std::vector<LinePlace>& places() const { return places_; }
    const FeatureOpening& opening() const { return opening_; }
    Eigen::Vector3d middle() const;  ///< between the corners, at rest

    /// Nothing where the model is behind the camera or a line was seen without extent.
    std::optional<OpeningOffsets> compare(const Camera& camera, const FaceState& state,
                                          const SeenOpening& seen, double interpupillary) const;

private:
    FeatureOpening opening_;
    std::vector<std::vector<SkinPoint>> lines_;
    std::vector<LinePlace> places_;
};

}  // namespace mimetic
