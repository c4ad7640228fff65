// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

namespace mimetic {

/// Points that the networks measure: lids and irises in an eye's crop, all others in the face's.
enum class NetworkFeature { upper_lid, lower_lid, eye_corner, iris, mouth_corner, outer_lip, inner_lip };

/// Error of a network's point, in sides of its crop: one standard deviation along the line of the eye or the
/// mouth, and across it. `mimetic evaluate real` measures it on four clips of three people
/// (docs/measured/real-faces.md).
struct FeatureNoise {
    /// Jitter from frame to frame on a still face: independent.
    Eigen::Vector2d jitter = Eigen::Vector2d::Zero();
    /// Error once the person's bias is removed. It lasts while pose and expression do, so that frames are not
    /// independent; it includes the error of the hand marking that it was measured against. Along the margin
    /// of a lid or a lip points are not distinguishable (aperture problem): only the error across is
    /// measured, and it stands for both.
    Eigen::Vector2d error = Eigen::Vector2d::Zero();
};

/// side: of the crop, pixels. Smaller crops have larger errors. Throws InvalidInput for a side that is not
/// positive.
FeatureNoise feature_noise(NetworkFeature feature, double side);

}  // namespace mimetic
