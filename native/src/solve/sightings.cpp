// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/sightings.hpp>
#include <string>

#include "error_field.hpp"
#include "seen_point.hpp"

namespace mimetic {

namespace {

constexpr int kMostPoints = 350;
// Radians and metres of the pose: nearly free
constexpr double kTurnStd = .1, kShiftStd = .02;

[[noreturn]] void fail(const std::string& text) { throw InvalidInput(text); }

/// Direction from the head to the camera, head frame.
Eigen::Vector3d view_direction(const Eigen::Isometry3d& camera_from_head) {
    return -(camera_from_head.linear().transpose() * camera_from_head.translation()).normalized();
}

std::vector<Eigen::Vector3d> points_of(VectorIn flat) {
    std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(flat.size() / 3));
    for (std::size_t k = 0; k < points.size(); ++k) {
        points[k] = flat.segment<3>(static_cast<Eigen::Index>(3 * k));
    }
    return points;
}

}  // namespace

FittedSkin::FittedSkin(const SubdividedMesh& surface, Points neutral_in, const Camera& camera_in,
                       const Eigen::Isometry3d& reference_pose_in)
    : stencils(surface.stencils()),
      neutral(std::move(neutral_in)),
      camera(camera_in),
      reference_pose(reference_pose_in) {
    camera.check();
    if (neutral.rows() != stencils.cols() || !neutral.allFinite() || !reference_pose.matrix().allFinite()) {
        fail("neutral must have the " + std::to_string(stencils.cols()) +
             " vertices of the surface, and be finite as the pose");
    }
    normals = surface.normals(neutral);
}

Eigen::Vector3d FittedSkin::camera_place() const {
    return -(reference_pose.linear().transpose() * reference_pose.translation());
}

Points FittedSkin::rays_to(const std::vector<int>& vertices) const {
    const Eigen::RowVector3d camera_at = camera_place().transpose();
    Points rays(static_cast<Eigen::Index>(vertices.size()), 3);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (vertices[i] < 0 || vertices[i] >= neutral.rows()) {
            fail("rays go to control vertices of the skin, of which there are " +
                 std::to_string(neutral.rows()));
        }
        rays.row(static_cast<Eigen::Index>(i)) = (neutral.row(vertices[i]) - camera_at).normalized();
    }
    return rays;
}

void Sighting::check() const {
    const Eigen::Index count = pixels.rows();
    if (vertices.rows() != count || barycentric.rows() != count || information.rows() != count) {
        fail("a sighting must have vertices, barycentric, pixels and information of as many points");
    }
    if (num_outline < 0 || num_outline > count) {
        fail("of a sighting's " + std::to_string(count) + " points, " + std::to_string(num_outline) +
             " cannot be of the outline");
    }
    if (!camera_from_head.matrix().allFinite() || !values.allFinite() || !barycentric.allFinite() ||
        !pixels.allFinite() || !information.allFinite()) {
        fail("the sighting of frame " + std::to_string(frame) + " is not finite");
    }
}

Sighting make_sighting(int frame, const FrameEstimate& estimate, const SkinObservations& seen,
                       const SkinObservations& outline) {
    std::vector<int> kept;
    for (int k = 0; k < seen.information.rows(); ++k) {
        if (seen.information(k, 0) + seen.information(k, 3) > 0) {
            kept.push_back(k);
        }
    }
    const int count = static_cast<int>(kept.size());
    const int share = std::max(1, (count + kMostPoints - 1) / kMostPoints);
    std::vector<int> chosen;
    for (int k = 0; k < count; k += share) {
        chosen.push_back(kept[static_cast<std::size_t>(k)]);
    }
    const auto num_chosen = static_cast<Eigen::Index>(chosen.size()), num_outline = outline.pixels.rows();
    const auto both = [&](const auto& of_seen, const auto& of_outline) {
        auto rows = std::decay_t<decltype(of_outline)>(num_chosen + num_outline, of_outline.cols());
        rows.topRows(num_chosen) = of_seen(chosen, Eigen::all);
        rows.bottomRows(num_outline) = of_outline;
        return rows;
    };
    Sighting sighting{frame,
                      estimate.camera_from_head,
                      estimate.values,
                      both(seen.vertices, outline.vertices),
                      both(seen.barycentric, outline.barycentric),
                      both(seen.pixels, outline.pixels),
                      both(seen.information, outline.information),
                      static_cast<int>(num_outline)};
    sighting.information.topRows(num_chosen) *= share;
    return sighting;
}

MatrixRows modes_at(const SparseRows& stencils, TrianglesIn vertices, PointsIn barycentric, MatrixIn modes) {
    if (modes.cols() != 3 * stencils.cols() || vertices.rows() != barycentric.rows()) {
        fail("modes must be of the skin's " + std::to_string(stencils.cols()) + " control vertices");
    }
    if (vertices.rows() > 0 && (vertices.minCoeff() < 0 || vertices.maxCoeff() >= stencils.rows())) {
        fail("a point names a vertex that is not one of the skin's " + std::to_string(stencils.rows()));
    }
    const MatrixRows by_vertex = modes.transpose();
    MatrixRows moved = MatrixRows::Zero(3 * vertices.rows(), modes.rows());
    for (Eigen::Index k = 0; k < vertices.rows(); ++k) {
        for (int corner = 0; corner < 3; ++corner) {
            for (SparseRows::InnerIterator entry(stencils, vertices(k, corner)); entry; ++entry) {
                moved.middleRows<3>(3 * k) +=
                    barycentric(k, corner) * entry.value() * by_vertex.middleRows<3>(3 * entry.col());
            }
        }
    }
    return moved;
}

DistinctPoints distinct_points(const std::vector<Sighting>& sightings) {
    struct Place {
        Eigen::RowVector3i vertices;
        Eigen::RowVector3d barycentric;
        std::size_t sighting;
        std::size_t point;
    };
    const auto key = [](const Place& place) {
        const auto& [v, b, sighting, point] = place;
        return std::array<double, 6>{double(v[0]), double(v[1]), double(v[2]), b[0], b[1], b[2]};
    };
    std::vector<Place> places;
    DistinctPoints distinct;
    for (std::size_t s = 0; s < sightings.size(); ++s) {
        const Sighting& one = sightings[s];
        for (Eigen::Index k = 0; k < one.vertices.rows(); ++k) {
            places.push_back({one.vertices.row(k), one.barycentric.row(k), s, static_cast<std::size_t>(k)});
        }
        distinct.index.emplace_back(one.vertices.rows());
    }
    std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) { return key(a) < key(b); });
    std::vector<std::size_t> firsts;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i == 0 || key(places[i - 1]) != key(places[i])) {
            firsts.push_back(i);
        }
        distinct.index[places[i].sighting][places[i].point] = static_cast<int>(firsts.size()) - 1;
    }
    const auto count = static_cast<Eigen::Index>(firsts.size());
    distinct.vertices.resize(count, 3);
    distinct.barycentric.resize(count, 3);
    for (Eigen::Index p = 0; p < count; ++p) {
        const Place& place = places[firsts[static_cast<std::size_t>(p)]];
        distinct.vertices.row(p) = place.vertices;
        distinct.barycentric.row(p) = place.barycentric;
    }
    return distinct;
}

Eigen::MatrixXd WeighedSighting::in_picture(MatrixIn moved) const {
    Eigen::MatrixXd shown(displacement.size(), moved.cols());
    for (std::size_t k = 0; k < by_point.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        shown.middleRows<2>(2 * at).noalias() = by_point[k] * moved.middleRows<3>(3 * at);
    }
    return shown;
}

WeighedSighting weigh(const Sighting& sighting, VectorIn rest, MatrixIn modes, const FittedSkin& skin,
                      const ModelError& error) {
    const auto points = points_of(rest);
    if (points.size() != static_cast<std::size_t>(sighting.pixels.rows()) || modes.rows() != rest.size() ||
        modes.cols() != sighting.values.size()) {
        fail("a sighting's points and values must be those of the modes");
    }
    const ErrorField<double> field(points);
    const double cosine = view_direction(skin.reference_pose).dot(view_direction(sighting.camera_from_head));
    const double sine = std::sqrt(std::max(0., 1 - cosine * cosine));
    const Eigen::VectorXd moved = modes * sighting.values;
    const auto num_nodes = static_cast<Eigen::Index>(field.num_nodes());
    WeighedSighting weighed{Eigen::VectorXd(2 * sighting.pixels.rows()), {}, {}};
    weighed.errors.setZero(weighed.displacement.size(), 6 + 2 * num_nodes);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const Eigen::Vector3d shift = moved.segment<3>(3 * row);
        const SeenPoint seen(skin.camera, sighting.camera_from_head, points[k] + shift);
        Eigen::Matrix2d information;
        information << sighting.information(row, 0), sighting.information(row, 1),
            sighting.information(row, 2), sighting.information(row, 3);
        const Eigen::Matrix2d root = (information + 1e-12 * Eigen::Matrix2d::Identity()).llt().matrixU();
        const Eigen::Vector2d displacement = sighting.pixels.row(row).transpose() -
                                             skin.camera.project(seen.in_camera) + seen.by_point * shift;
        weighed.displacement.segment<2>(2 * row) = root * displacement;
        weighed.by_point.push_back(root * seen.by_point);
        auto errors = weighed.errors.middleRows<2>(2 * row);
        errors.leftCols<3>() = kTurnStd * root * seen.by_rotation;
        errors.middleCols<3>(3) = kShiftStd * root * seen.by_shift;
        const double std = error.std_of(sine, shift.norm());
        // In the head's x and y: all x first
        for (const auto& [node, height] : field.near(points[k])) {
            errors.col(6 + node) = std * height * weighed.by_point[k].col(0);
            errors.col(6 + num_nodes + node) = std * height * weighed.by_point[k].col(1);
        }
    }
    return weighed;
}

WhitenedSighting::WhitenedSighting(const FittedSkin& skin, const Sighting& sighting, MatrixIn modes,
                                   const ModelError& error)
    : sighting_(sighting) {
    sighting_.check();
    const Eigen::Map<const MatrixRows> neutral(skin.neutral.data(), 1, skin.neutral.size());
    const MatrixRows rest = modes_at(skin.stencils, sighting.vertices, sighting.barycentric, neutral);
    const MatrixRows moved = modes_at(skin.stencils, sighting.vertices, sighting.barycentric, modes);
    weighed_ = weigh(sighting, rest.col(0), moved, skin, error);
    const Eigen::Index size = weighed_.displacement.size();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(size, size);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(weighed_.errors);
    root_.compute(covariance);
    displacement_ = root_.matrixL().solve(weighed_.displacement);
}

Eigen::MatrixXd WhitenedSighting::in_picture(MatrixIn moved) const {
    return root_.matrixL().solve(weighed_.in_picture(moved));
}

}  // namespace mimetic
