// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

namespace mimetic {

/// Points that the networks say: lids and irises of an eye's crop, all others of the face's.
enum class NetworkFeature { upper_lid, lower_lid, eye_corner, iris, mouth_corner, outer_lip, inner_lip };

/// What a network's point is off by, in sides of its crop: one standard deviation along the line of the eye
/// or the mouth, and across it. `mimetic evaluate real` measures it on four clips of three people
/// (docs/measured/real-faces.md).
struct FeatureNoise {
    /// From frame to frame where the face keeps still: independent.
    Eigen::Vector2d jitter = Eigen::Vector2d::Zero();
    /// What is left once the person's bias is known. It stays while pose and expression do, so that frames
    /// are no independent witnesses; the error of the marking that it was measured by is in it. Along the
    /// margin of a lid or a lip nothing tells one place from the next: across it alone is known, and the
    /// same is said of both.
    Eigen::Vector2d error = Eigen::Vector2d::Zero();
};

/// side: of the crop, pixels. Small crops show less. Throws InvalidInput for a side that is not positive.
FeatureNoise feature_noise(NetworkFeature feature, double side);

}  // namespace mimetic
