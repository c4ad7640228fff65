// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <utility>

#include "sample_view.hpp"

namespace mimetic::head {

/// Samples of reference textures with their weights.
using ViewShares = std::vector<std::pair<double, const SampleView*>>;

struct Registration {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();  ///< exp(rotation) R, t + translation; model error included
    double correlation = 0;                ///< of samples and frame, -1 to 1
    double in_sight = 0;                   ///< visible share of the samples
    double explained = 0;                  ///< share of the skin that matches the references
    double residual_px = 0;                ///< rms of the inliers, pixels of the finest level
    int num_samples = 0;
};

/// Only the coarsest level: the correlation decides which of two guesses is the better one.
Registration register_coarsely(const ViewShares& views, const Pyramid& now, const Eigen::Isometry3d& start,
                               const HeadOptions& options);

/// The pose in which the frame shows what the reference textures show, by inverse composition
/// [Baker & Matthews 2004] on samples of skin, coarse to fine, with robust weights.
Registration register_views(const ViewShares& views, const Pyramid& now, const Eigen::Isometry3d& start,
                            const HeadOptions& options);

}  // namespace mimetic::head
