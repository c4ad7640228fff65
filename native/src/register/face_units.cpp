// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/register/face_units.hpp>
#include <mimetic/shared/checks.hpp>
#include <utility>
#include <vector>

namespace mimetic {
namespace {

constexpr int kSmoothing = 2;        // rounds of averaging the maps with their neighbours'
constexpr double kRidge = 1e-3;      // of the edges' squares: a map that edges leave open stays as it is
constexpr double kCornerRoom = .04;  // of the slit's length, without pairs

using Maps = Rows<double, 9>;
using Square = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Maps smoothed(const Maps& maps, TrianglesIn triangles) {
    Maps sums = maps;
    Eigen::VectorXd counts = Eigen::VectorXd::Ones(maps.rows());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
            sums.row(a) += maps.row(b);
            sums.row(b) += maps.row(a);
            counts[a] += 1;
            counts[b] += 1;
        }
    }
    return sums.array().colwise() / counts.array();
}

/// Points of a rim at the given shares of the way from the first corner to the second.
Points at_shares(PointsIn rim, PointsIn corners, const Eigen::VectorXd& shares) {
    const Eigen::RowVector3d along = corners.row(1) - corners.row(0);
    std::vector<std::pair<double, Eigen::RowVector3d>> places{{0, corners.row(0)}, {1, corners.row(1)}};
    for (Eigen::Index i = 0; i < rim.rows(); ++i) {
        const double share = (rim.row(i) - corners.row(0)).dot(along) / along.squaredNorm();
        if (share > 0 && share < 1) {
            places.emplace_back(share, rim.row(i));
        }
    }
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    Points points(shares.size(), 3);
    for (Eigen::Index k = 0; k < shares.size(); ++k) {
        std::size_t next = 1;
        while (next + 1 < places.size() && places[next].first < shares[k]) {
            ++next;
        }
        const auto& [low, before] = places[next - 1];
        const auto& [high, after] = places[next];
        const double part = high > low ? std::clamp((shares[k] - low) / (high - low), 0., 1.) : 0.;
        points.row(k) = (1 - part) * before + part * after;
    }
    return points;
}

}  // namespace

Maps surface_maps(PointsIn source, PointsIn target, TrianglesIn triangles) {
    require(source.rows() == target.rows(), "both surfaces need as many vertices");
    require(triangles.size() == 0 || (triangles.minCoeff() >= 0 && triangles.maxCoeff() < source.rows()),
            "a triangle names a vertex that the surfaces do not have");
    const Points from_normals = area_normals(source, triangles), to_normals = area_normals(target, triangles);
    std::vector<Eigen::Matrix3d> outer(static_cast<std::size_t>(source.rows()), Eigen::Matrix3d::Zero()),
        cross = outer;
    const auto add = [&](int v, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        outer[static_cast<std::size_t>(v)] += from * from.transpose();
        cross[static_cast<std::size_t>(v)] += to * from.transpose();
    };
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
            const Eigen::Vector3d from = source.row(b) - source.row(a), to = target.row(b) - target.row(a);
            add(a, from, to);
            add(b, from, to);
        }
    }
    Maps maps(source.rows(), 9);
    for (Eigen::Index v = 0; v < source.rows(); ++v) {
        const auto at = static_cast<std::size_t>(v);
        const double squares = outer[at].trace();
        Square map = Square::Identity();
        const double from_length = from_normals.row(v).norm(), to_length = to_normals.row(v).norm();
        if (squares > 0 && from_length > 0 && to_length > 0) {
            // Across the skin there are no edges: it gets thicker as it gets wider
            const double stretch = std::sqrt(to_length / from_length);
            const Eigen::Vector3d from = from_normals.row(v).transpose() / from_length,
                                  to = stretch * to_normals.row(v).transpose() / to_length;
            const Eigen::Matrix3d left =
                cross[at] + squares * to * from.transpose() + kRidge * squares * Eigen::Matrix3d::Identity();
            const Eigen::Matrix3d right = outer[at] + squares * from * from.transpose() +
                                          kRidge * squares * Eigen::Matrix3d::Identity();
            map = left * right.inverse();
        }
        maps.row(v) = Eigen::Map<const Eigen::Matrix<double, 1, 9>>(map.data());
    }
    for (int round = 0; round < kSmoothing; ++round) {
        maps = smoothed(maps, triangles);
    }
    return maps;
}

Points carried_by(const Maps& maps, PointsIn displacement) {
    require(maps.rows() == displacement.rows(), "there must be a map for each displacement");
    Points carried(displacement.rows(), 3);
    for (Eigen::Index v = 0; v < displacement.rows(); ++v) {
        carried.row(v) =
            (Eigen::Map<const Square>(maps.row(v).data()) * displacement.row(v).transpose()).transpose();
    }
    return carried;
}

RimPairs rim_pairs(PointsIn upper, PointsIn lower, PointsIn corners, int count) {
    require(corners.rows() == 2 && count > 0, "a slit has two corners and at least one pair");
    const Eigen::VectorXd shares = Eigen::VectorXd::LinSpaced(count, kCornerRoom, 1 - kCornerRoom);
    return {at_shares(upper, corners, shares), at_shares(lower, corners, shares)};
}

}  // namespace mimetic
