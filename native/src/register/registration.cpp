// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/register/registration.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin.hpp>

#include "skin/mesh_edges.hpp"

namespace mimetic {
namespace {

constexpr double kNormalLength = .008;  // m that opposite normals count as, halved: lips touch back to back
constexpr double kLipLength = .008;     // m that upper and lower lip count as apart, though they touch
constexpr double kLipFull = .010;       // m of difference between the geodesic distances to the two lips
constexpr double kFar = .15;            // m; limit of geodesic distances
constexpr double kAlike = .3;           // cosine of normals of skin that is drawn to other skin
constexpr double kAcross = 3e6, kAlong = 1e5, kLoose = 30;  // N/m^3; the membrane smooths the pull over 5 mm
constexpr double kLandmark = 1e8;                           // N/m^3
constexpr double kYoung = 4e4, kThickness = 1.5e-3;         // Pa, m

Eigen::VectorXd lips_of(const MuscleSurface& surface, PointsIn lips) {
    const Eigen::VectorXd upper = surface.distances(lips.row(0), kFar).cwiseMin(kFar);
    const Eigen::VectorXd lower = surface.distances(lips.row(1), kFar).cwiseMin(kFar);
    return ((lower - upper) / kLipFull).cwiseMax(-1).cwiseMin(1);
}

/// P x 7: position, and what else has to agree, scaled to lengths.
MatrixRows features(PointsIn points, PointsIn normals, VectorIn lip) {
    MatrixRows result(points.rows(), 7);
    result << points, kNormalLength * normals, kLipLength * lip;
    return result;
}

std::vector<bool> on_rim(const Triangles& triangles, Eigen::Index num_vertices) {
    std::vector<bool> rim(static_cast<std::size_t>(num_vertices), false);
    for (const Edge& edge : boundary_edges(triangles)) {
        rim[static_cast<std::size_t>(edge.from)] = rim[static_cast<std::size_t>(edge.to)] = true;
    }
    return rim;
}

/// Target displacements of the refined skin, and the stiffness of the pull.
struct Pull {
    Points displacements;                ///< N x 3
    Eigen::VectorXd tangential, normal;  ///< N, N/m^3
};

Pull pull_to(const LaidTemplate& laid, const LippedSurface& surface, double reach) {
    const LippedSurface& own = laid.skin;
    const SkinPlaces places = surface.find(own.vertices(), own.normals(), own.lip());
    const Points there = places.values(surface.vertices()), normals = places.values(surface.normals());
    const std::vector<bool> rim = on_rim(surface.triangles(), surface.vertices().rows());
    const Eigen::Index count = own.vertices().rows();
    Pull pull{Points::Zero(count, 3), Eigen::VectorXd::Constant(count, kLoose),
              Eigen::VectorXd::Constant(count, kLoose)};
    for (Eigen::Index v = 0; v < count; ++v) {
        // The mesh ends at its rim: what lies beyond must not be gathered there
        const bool at_end = rim[static_cast<std::size_t>(places.corners(v, 0))] ||
                            rim[static_cast<std::size_t>(places.corners(v, 1))] ||
                            rim[static_cast<std::size_t>(places.corners(v, 2))];
        const bool is_alike = normals.row(v).dot(own.normals().row(v)) > kAlike;
        if (laid.outer[static_cast<std::size_t>(v)] && is_alike && places.gaps[v] < reach && !at_end) {
            pull.displacements.row(v) = there.row(v) - own.vertices().row(v);
            pull.tangential[v] = kAlong;
            pull.normal[v] = kAcross;
        }
    }
    return pull;
}

}  // namespace

LippedSurface::LippedSurface(PointsIn vertices, TrianglesIn triangles, const MuscleSurface& surface,
                             PointsIn lips)
    : vertices_(vertices),
      triangles_(triangles),
      normals_(surface.normals()),
      lip_(lips.rows() == 2 && normals_.rows() == vertices.rows()
               ? lips_of(surface, lips)
               : throw InvalidInput("a surface with lips needs a point on each, and a normal a vertex")),
      around_(triangles, static_cast<int>(vertices.rows())),
      nearest_(features(vertices_, normals_, lip_)(around_.used(), Eigen::all)) {}

SkinPlaces LippedSurface::find(PointsIn points, PointsIn normals, VectorIn lip) const {
    if (normals.rows() != points.rows() || lip.size() != points.rows()) {
        throw InvalidInput("each point needs a normal and a lip");
    }
    Eigen::VectorXi near = nearest_.find(features(points, normals, lip));
    for (int& vertex : near) {
        vertex = around_.used()[static_cast<std::size_t>(vertex)];
    }
    return around_.closest(points, near, vertices_);
}

SparseRows carrier_rows(const SkinPlaces& places, const SparseRows& stencils, double reach) {
    if (places.corners.size() != 0 &&
        (places.corners.minCoeff() < 0 || places.corners.maxCoeff() >= stencils.rows())) {
        throw InvalidInput("places lie on a skin of more than " + std::to_string(stencils.rows()) +
                           " vertices");
    }
    SparseRows weights(places.corners.rows(), stencils.rows());
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(places.corners.size()));
    for (Eigen::Index i = 0; i < places.corners.rows(); ++i) {
        const double share = smooth_step(2 - 2 * places.gaps[i] / reach);
        for (int k = 0; k < 3 && share > 0; ++k) {
            entries.emplace_back(static_cast<int>(i), places.corners(i, k), share * places.weights(i, k));
        }
    }
    weights.setFromTriplets(entries.begin(), entries.end());
    return weights * stencils;
}

Points warp_points(PointsIn points, PointsIn source, PointsIn target) {
    const Eigen::Index count = source.rows();
    if (count == 0 || target.rows() != count) {
        throw InvalidInput("a warp needs a target for each of its sources, and one at least");
    }
    Eigen::MatrixXd system = Eigen::MatrixXd::Ones(count + 1, count + 1);
    for (Eigen::Index i = 0; i < count; ++i) {
        system.row(i).head(count) = -(source.rowwise() - source.row(i)).rowwise().norm().transpose();
    }
    system(count, count) = 0;
    Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(count + 1, 3);
    wanted.topRows(count) = target - source;
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(system);
    if (!solver.isInvertible()) {
        throw InvalidInput("two landmarks lie at the same place: move them apart");
    }
    const Eigen::MatrixXd weights = solver.solve(wanted);
    Points moved(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::VectorXd near = -(source.rowwise() - points.row(i)).rowwise().norm();
        moved.row(i) = points.row(i) + near.transpose() * weights.topRows(count) + weights.row(count);
    }
    return moved;
}

Points draw_to_surface(const LaidTemplate& laid, PointsIn targets, const LippedSurface& surface,
                       double reach) {
    const Points& vertices = laid.skin.vertices();
    if (targets.rows() != static_cast<Eigen::Index>(laid.held.size()) ||
        laid.outer.size() != static_cast<std::size_t>(vertices.rows())) {
        throw InvalidInput("a target is needed for each landmark, and for each vertex whether it is outside");
    }
    if (laid.stencils.cols() > laid.neutral.rows()) {
        throw InvalidInput("the skin has " + std::to_string(laid.stencils.cols()) + " vertices, the head " +
                           std::to_string(laid.neutral.rows()));
    }
    Pull pull = pull_to(laid, surface, reach);
    for (std::size_t i = 0; i < laid.held.size(); ++i) {
        const int vertex = laid.held[i];
        pull.displacements.row(vertex) = targets.row(static_cast<Eigen::Index>(i)) - vertices.row(vertex);
        pull.normal[vertex] = pull.tangential[vertex] = kLandmark;
    }
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(vertices.rows());
    const SkinMaterials materials{kYoung * one, 0 * one,         kThickness * one,
                                  0 * one,      pull.tangential, pull.normal};
    const SkinModel model(vertices, laid.skin.triangles(), materials, laid.stencils);
    const Points forces = model.foundation_forces(pull.displacements);
    const Eigen::MatrixXd solved = model.solve(forces.reshaped<Eigen::RowMajor>());
    Points neutral = laid.neutral;
    const Points moved = Eigen::Map<const Points>(solved.data(), laid.stencils.cols(), 3);
    neutral.topRows(moved.rows()) += moved;
    for (const Follower& follower : laid.followers) {
        const Eigen::RowVector3d mean = moved(follower.edge, Eigen::all).colwise().mean();
        for (const int vertex : follower.vertices) {
            neutral.row(vertex) += mean;
        }
    }
    return neutral;
}

}  // namespace mimetic
