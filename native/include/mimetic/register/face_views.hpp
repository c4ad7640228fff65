// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/register/shown_head.hpp>
#include <mimetic/shared/progress.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// What the face network sees in one picture of a head, carried onto the mesh.
struct FaceView {
    Points places;        ///< 468 x 3, the mesh's frame; not finite where a point lies beside the mesh
    double presence = 0;  ///< 0 to 1, probability of a face
    FeatureCrop crop;     ///< that the network saw
};

/// Pictures of a head in the template's frame and size: degrees that it is turned (to its left) and lowered,
/// and where the lamp is.
struct ViewDirection {
    double yaw = 0;
    double pitch = 0;
    Eigen::Vector3d light = Eigen::Vector3d::UnitZ();
};

/// From the front and from both sides, each lit from several places; the first is the front.
std::vector<ViewDirection> view_directions();

/// The face in each of `directions`. starts: where the network looks first in each (`FaceView::crop` of
/// another head), or empty. Stopped by progress, it returns the views it has.
std::vector<FaceView> face_views(const ShownHead& head, const FeatureNetworks& networks,
                                 const std::vector<ViewDirection>& directions,
                                 const std::vector<FeatureCrop>& starts, const Progress& progress = {});

/// How a mesh of any axes and size lies: a face was found in pictures of it.
struct Facing {
    Similarity mesh_from_template;
    double misfit = 0;  ///< root mean square from the template's points, interpupillary distances
};

/// Looks at the mesh along its axes, heads that look along -y (z up) and z (y up) first. reference: the
/// template's face from the front. Nothing where no face is seen, or progress stopped the search.
std::optional<Facing> find_facing(const ShownHead& head, const FeatureNetworks& networks,
                                  const FaceView& reference, const Progress& progress = {});

}  // namespace mimetic
