// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <mimetic/locate/eye_regressor.hpp>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/still_cover.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// An opening of the face, an eye or the mouth: the lines that run on the skin from one corner to the other.
struct FeatureOpening {
    std::vector<std::vector<int>> lines;  ///< control vertices; of an eye the upper and the lower margin;
                                          ///< of a mouth four, of which the two in the middle meet
    int lid_upper = -1;                   ///< index among the values, -1: no eye
    int lid_lower = -1;
    /// Values by which it shuts: they need not be 0 in the reference frame.
    std::vector<int> shutting;
    /// Index among the values of what parts lips by bone, -1: nothing. How the skin follows it along the
    /// lines is not well known.
    int jaw = -1;
    /// Head frame, of any length: which way it faces. An opening seen from the side constrains little.
    Eigen::Vector3d facing = Eigen::Vector3d::UnitZ();
};

/// An iris as it was seen in a frame.
struct SeenIris {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< pixels
    double side = 0;                                   ///< of the network's crop, pixels; 0: no iris was seen
    double opening = 0;   ///< between the lids' middles, in diameters of the iris
    double presence = 0;  ///< 0 to 1: probability that the eye is there at all
    double doubt = 1;     ///< times the networks' error
};

/// Where the same lines were seen in a frame.
struct SeenOpening {
    std::vector<Points2> lines;  ///< pixels, from the first corner to the second; empty: not seen
    double presence = 1;         ///< 0 to 1: probability that the opening is there at all
    double doubt = 1;            ///< times the networks' error
    SeenIris iris = {};          ///< of an eye
};

/// Measures the openings of a face, in their order, in a frame in which the head is near a pose.
using FeatureSource = std::function<std::vector<SeenOpening>(const ColorView& image,
                                                             const Eigen::Isometry3d& camera_from_head)>;

/// Sees what is before a face, in a frame in which the head is near a pose; nothing where it is not in sight.
using OcclusionSource =
    std::function<Occlusion(const ColorView& image, const Eigen::Isometry3d& camera_from_head)>;

/// Where eyes and mouth are on the head, and the source that measures them.
struct FeatureInputs {
    std::vector<FeatureOpening> openings;  ///< in the source's order
    FeatureSource source;                  ///< may be empty
    OcclusionSource occlusion = {};        ///< of the whole face; may be empty
    StillCover still_cover = {};           ///< in all frames; looked at beside `occlusion`
};

/// By the networks for mesh and iris, which must outlive it: of the left eye, of the right eye (the upper and
/// the lower margin, from the outer to the inner corner), and of the mouth (outer upper, inner upper, inner
/// lower, outer lower edge, from the subject's right to the left). anchors: as `feature_crops` has them.
FeatureSource see_by_networks(const FeatureNetworks& networks, const Camera& camera, PointsIn anchors);

/// The same eyes by the regressor, which must outlive it, and no mouth.
FeatureSource see_by_regressor(const EyeRegressor& regressor, const Camera& camera, PointsIn anchors);

/// By the network, which must outlive it.
OcclusionSource see_occlusion(const OcclusionNetwork& network, const Camera& camera);

}  // namespace mimetic
