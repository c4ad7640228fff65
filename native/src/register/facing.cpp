// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/register/face_views.hpp>
#include <mimetic/shared/scale.hpp>

#include "view_camera.hpp"

namespace mimetic {
namespace {

constexpr int kSearchSize = 512;        // pixels of a side: a face on a whole body still has forty
constexpr double kPresent = .5;         // of the network: there is a face at all
constexpr double kCertainMisfit = .10;  // interpupillary distances: no other direction is tried
constexpr double kLargestMisfit = .45;  // of anything that is taken for a face
constexpr int kRounds = 3;              // of looking again, the mesh aligned with what was seen
constexpr double kShare = .6;           // of the points that must lie on the mesh

/// Directions that a mesh may look in and have its top in, the likely ones first; the mesh's rotation into
/// the frame of the template: x to the subject's left, y up, z forwards.
std::vector<Eigen::Matrix3d> axis_rotations() {
    std::vector<Eigen::Matrix3d> rotations;
    const auto add = [&](const Eigen::Vector3d& up, const Eigen::Vector3d& front) {
        Eigen::Matrix3d rotation;
        rotation << up.cross(front).transpose(), up.transpose(), front.transpose();
        if (std::none_of(rotations.begin(), rotations.end(),
                         [&](const Eigen::Matrix3d& other) { return other.isApprox(rotation); })) {
            rotations.push_back(rotation);
        }
    };
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                          z = Eigen::Vector3d::UnitZ();
    add(z, -y);  // Blender's
    add(y, z);   // glTF's and most others'
    for (const Eigen::Vector3d& up : {z, y, x}) {
        for (const double sign : {1., -1.}) {
            for (const Eigen::Vector3d& front :
                 {Eigen::Vector3d(-y), z, Eigen::Vector3d(y), Eigen::Vector3d(-z), x, Eigen::Vector3d(-x)}) {
                if (std::abs(up.dot(front)) < .5) {
                    add(sign * up, front);
                }
            }
        }
    }
    return rotations;
}

/// Crops in which a face may lie, of a mesh that is `width` x `height` pixels about the picture's middle.
std::vector<FeatureCrop> search_crops(double width, double height) {
    const double middle = (kSearchSize - 1) / 2.;
    std::vector<FeatureCrop> crops;
    const double longest = std::max(width, height);
    for (const double share : {.9, .65, .45}) {
        const double side = share * longest, room = std::max(0., height - .8 * side);
        const int steps = static_cast<int>(std::ceil(room / (.3 * side)));
        for (int i = 0; i <= steps; ++i) {
            const double y = steps == 0 ? 0 : room * (static_cast<double>(i) / steps - .5);
            crops.push_back({{middle, middle + y}, side, 0});
        }
    }
    if (height > .9 * width) {  // a body: its face is near the top
        for (const double share : {.28, .2, .14}) {
            for (const double down : {.3, .5, .7}) {
                crops.push_back({{middle, middle - height / 2 + down * share * height}, share * height, 0});
            }
        }
    }
    return crops;
}

/// The similarity that carries the template's points to those seen, without the worst; nothing if they are
/// no face.
std::optional<Facing> facing_of(const FaceView& reference, const FaceView& view) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < view.places.rows(); ++i) {
        if (view.places.row(i).allFinite() && reference.places.row(i).allFinite()) {
            rows.push_back(i);
        }
    }
    if (!(view.presence > kPresent) ||
        static_cast<double>(rows.size()) < kShare * static_cast<double>(view.places.rows())) {
        return std::nullopt;
    }
    Facing facing;
    for (int round = 0; round < 3; ++round) {
        const Points from = reference.places(rows, Eigen::all), to = view.places(rows, Eigen::all);
        facing.mesh_from_template = fit_similarity(from, to);
        const double scale = facing.mesh_from_template.scale * kPupilDistance;
        const Eigen::VectorXd gaps =
            (facing.mesh_from_template.apply(from) - to).rowwise().norm() / std::max(scale, 1e-300);
        facing.misfit = std::sqrt(gaps.squaredNorm() / static_cast<double>(gaps.size()));
        std::vector<Eigen::Index> near;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (gaps[static_cast<Eigen::Index>(i)] < 2.5 * facing.misfit) {
                near.push_back(rows[i]);
            }
        }
        rows = std::move(near);
    }
    if (facing.mesh_from_template.is_mirror || !(facing.misfit < kLargestMisfit)) {
        return std::nullopt;
    }
    return facing;
}

/// Looks again with the mesh aligned, until what is seen stays.
std::optional<Facing> refined(const ShownHead& head, const FeatureNetworks& networks,
                              const FaceView& reference, Facing facing) {
    for (int round = 0; round < kRounds; ++round) {
        const Similarity template_from_mesh = facing.mesh_from_template.inverse();
        FaceView view =
            face_views(head.aligned(template_from_mesh), networks, {ViewDirection{}}, {reference.crop})[0];
        view.places = facing.mesh_from_template.apply(view.places);
        const std::optional<Facing> closer = facing_of(reference, view);
        if (!closer) {
            return std::nullopt;
        }
        facing = *closer;
    }
    return facing;
}

}  // namespace

std::optional<Facing> find_facing(const ShownHead& head, const FeatureNetworks& networks,
                                  const FaceView& reference, const Progress& progress) {
    const Eigen::Vector3d low = head.mesh.vertices.colwise().minCoeff().transpose(),
                          high = head.mesh.vertices.colwise().maxCoeff().transpose();
    const double extent = 1.1 * (high - low).maxCoeff();
    std::optional<Facing> best;
    const std::vector<Eigen::Matrix3d> rotations = axis_rotations();
    for (std::size_t r = 0; r < rotations.size(); ++r) {
        if (progress && !progress(static_cast<double>(r) / static_cast<double>(rotations.size()))) {
            return std::nullopt;
        }
        const ShadedView view(head, rotations[r], (low + high) / 2, extent, kSearchSize,
                              Eigen::Vector3d(0, .2, 1).normalized());
        const Eigen::Vector3d size = (rotations[r] * (high - low)).cwiseAbs() * (kSearchSize / extent);
        std::optional<Facing> seen;
        for (const FeatureCrop& crop : search_crops(size.x(), size.y())) {
            if (!(networks.mesh(view.shaded.picture.view(), crop).presence > kPresent)) {
                continue;
            }
            const std::optional<Facing> one = facing_of(reference, settled_view(view, networks, crop));
            if (one && (!seen || one->misfit < seen->misfit)) {
                seen = one;
            }
        }
        if (seen) {
            seen = refined(head, networks, reference, *seen);
        }
        if (seen && (!best || seen->misfit < best->misfit)) {
            best = seen;
        }
        if (best && best->misfit < kCertainMisfit) {
            break;
        }
    }
    return best;
}

}  // namespace mimetic
