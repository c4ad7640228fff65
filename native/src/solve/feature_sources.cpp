// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <mimetic/locate/well_lit.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/features.hpp>
#include <opencv2/core/utility.hpp>

namespace mimetic {

namespace {

template <typename Indices>
Points2 line_of(const Points2& places, const Indices& indices) {
    return places(std::vector<int>(indices.begin(), indices.end()), Eigen::all);
}

SeenIris iris_of(const EyePoints& points, const FeatureCrop& crop) {
    // Across, from side to side: lids cover the rim above and below
    const double diameter = (points.iris.row(1) - points.iris.row(3)).norm();
    constexpr std::size_t kMiddle = 4;
    static_assert(LidMargins::kUpper.size() == 2 * kMiddle + 1 &&
                  LidMargins::kLower.size() == 2 * kMiddle + 1);
    const double opening =
        (points.contour.row(LidMargins::kUpper[kMiddle]) - points.contour.row(LidMargins::kLower[kMiddle]))
            .norm();
    if (!(diameter > 0)) {
        return {};
    }
    return {points.iris.row(0).transpose(), crop.side, opening / diameter, 0};
}

/// By networks or a regressor.
template <typename Source>
void see_eyes(const Source& source, const ColorView& image, const FeatureCrops& crops,
              std::vector<SeenOpening>& seen) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const EyePoints points = source.eye(image, crops.eyes[eye], eye == 0);
        seen[eye].lines = {line_of(points.contour, LidMargins::kUpper),
                           line_of(points.contour, LidMargins::kLower)};
        seen[eye].iris = iris_of(points, crops.eyes[eye]);
        seen[eye].doubt = points.lid_doubt;
        seen[eye].iris.doubt = points.iris_doubt;
    }
}

/// Sees on the crops of each frame, well lit; nothing where one lies beside the picture.
template <typename See>
FeatureSource on_crops(const Camera& camera, PointsIn anchors, const See& see) {
    return [camera, places = Points(anchors), see](const ColorView& image,
                                                   const Eigen::Isometry3d& camera_from_head) {
        std::vector<SeenOpening> seen(3);
        try {
            const FeatureCrops crops = feature_crops(camera, camera_from_head, places);
            const std::optional<ColorImage> lit = well_lit(image, crops.face);
            see(lit ? lit->view() : image, crops, seen);
        } catch (const InvalidInput&) {
            return std::vector<SeenOpening>(3);
        }
        return seen;
    };
}

}  // namespace

FeatureSource see_by_networks(const FeatureNetworks& networks, const Camera& camera, PointsIn anchors) {
    return on_crops(
        camera, anchors,
        [&networks](const ColorView& image, const FeatureCrops& crops, std::vector<SeenOpening>& seen) {
            MeshPoints mesh;
            // Eyes and face are networks of their own, each of them fastest in one thread
            cv::parallel_for_({0, 2}, [&](const cv::Range& range) {
                for (int part = range.start; part < range.end; ++part) {
                    if (part == 0) {
                        see_eyes(networks, image, crops, seen);
                    } else {
                        mesh = networks.mesh(image, crops.face);
                    }
                }
            });
            for (const auto& line : {LipEdges::kOuterUpper, LipEdges::kInnerUpper, LipEdges::kInnerLower,
                                     LipEdges::kOuterLower}) {
                seen[2].lines.push_back(line_of(mesh.places, line));
            }
            for (SeenOpening& opening : seen) {
                opening.presence = opening.iris.presence = mesh.presence;
            }
        });
}

FeatureSource see_by_regressor(const EyeRegressor& regressor, const Camera& camera, PointsIn anchors) {
    return on_crops(
        camera, anchors,
        [&regressor](const ColorView& image, const FeatureCrops& crops, std::vector<SeenOpening>& seen) {
            see_eyes(regressor, image, crops, seen);
            for (SeenOpening& opening : seen) {
                opening.iris.presence = 1;  // it does not say whether there is an eye: the followed face does
            }
        });
}

OcclusionSource see_occlusion(const OcclusionNetwork& network, const Camera& camera) {
    return [&network, camera](const ColorView& image, const Eigen::Isometry3d& camera_from_head) {
        try {
            return network.see(image, occlusion_square(camera, camera_from_head));
        } catch (const InvalidInput&) {
            return Occlusion{};
        }
    };
}

}  // namespace mimetic
