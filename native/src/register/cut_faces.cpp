// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mimetic/muscles/skin_mesh.hpp>
#include <mimetic/register/foreign_skin.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kNothing = 1e-12;  // of an object's volume

std::string name_corners(const LongQuads& faces, Eigen::Index f) {
    std::string text;
    for (int k = 0; k < (faces(f, 3) >= 0 ? 4 : 3); ++k) {
        text += (k ? ", " : "") + std::to_string(faces(f, k));
    }
    return "[" + text + "]";
}

/// The corner (0 to count - 1) whose fan of triangles has the largest smallest one.
int best_corner(PointsIn points, const std::int64_t* corners, int count) {
    int best = 0;
    double largest = -1;
    for (int first = 0; first < count; ++first) {
        const auto at = [&](int k) -> Eigen::RowVector3d { return points.row(corners[(first + k) % count]); };
        double least = std::numeric_limits<double>::infinity();
        for (int k = 1; k + 1 < count; ++k) {
            least = std::min(least, (at(k) - at(0)).cross(at(k + 1) - at(0)).norm());
        }
        if (least > largest) {
            largest = least;
            best = first;
        }
    }
    return best;
}

}  // namespace

CutFaces cut_faces(PointsIn points, const Eigen::Ref<const LongQuads>& faces) {
    std::vector<Eigen::Index> triangles, quads;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const bool is_quad = faces(f, 3) >= 0;
        (is_quad ? quads : triangles).push_back(f);
        for (int k = 0; k < (is_quad ? 4 : 3); ++k) {
            if (faces(f, k) < 0 || faces(f, k) >= points.rows()) {
                throw InvalidInput("face " + std::to_string(f) +
                                   " names a vertex that the mesh does not have: " + name_corners(faces, f));
            }
        }
    }
    const Quads corners = faces(quads, Eigen::all).cast<int>();
    const auto num_triangles = static_cast<Eigen::Index>(triangles.size());
    CutFaces cut{Triangles(num_triangles + 2 * corners.rows(), 3), {}};
    cut.triangles.topRows(num_triangles) = faces(triangles, Eigen::seqN(0, 3)).cast<int>();
    cut.triangles.bottomRows(2 * corners.rows()) = split_quads(points, corners);
    cut.face.resize(cut.triangles.rows());
    for (Eigen::Index t = 0; t < cut.face.size(); ++t) {
        const auto row = static_cast<std::size_t>(t < num_triangles ? t : (t - num_triangles) / 2);
        cut.face[t] = static_cast<int>(t < num_triangles ? triangles[row] : quads[row]);
    }
    return cut;
}

PolygonPieces cut_polygons(PointsIn points, const std::vector<std::int64_t>& starts,
                           const std::vector<std::int64_t>& corners) {
    std::map<std::int64_t, std::vector<std::size_t>> by_count;
    Eigen::Index num_pieces = 0;
    for (std::size_t p = 0; p < starts.size(); ++p) {
        const auto end = p + 1 < starts.size() ? starts[p + 1] : static_cast<std::int64_t>(corners.size());
        if (starts[p] < 0 || end - starts[p] < 3) {
            throw InvalidInput("the mesh has no faces, or one of fewer than three corners");
        }
        by_count[end - starts[p]].push_back(p);
        num_pieces += end - starts[p] == 4 ? 1 : end - starts[p] - 2;
    }
    if (starts.empty() || starts.back() >= static_cast<std::int64_t>(corners.size())) {
        throw InvalidInput("the mesh has no faces, or one of fewer than three corners");
    }
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    if (*low < 0 || *high >= points.rows()) {
        throw InvalidInput("a face of the mesh names a vertex that it does not have");
    }
    PolygonPieces pieces{LongQuads(num_pieces, 4), Eigen::VectorXi(num_pieces)};
    Eigen::Index row = 0;
    for (const auto& [length, polygons] : by_count) {
        const int count = static_cast<int>(length);
        const int num_own = count == 4 ? 1 : count - 2;
        for (int k = 1; k <= num_own; ++k) {  // a fan's first triangles, then its second ones
            for (const std::size_t p : polygons) {
                const std::int64_t* own = corners.data() + starts[p];
                const int first = count > 4 ? best_corner(points, own, count) : 0;
                pieces.faces.row(row) << own[first], own[(first + k) % count], own[(first + k + 1) % count],
                    count == 4 ? own[3] : -1;
                pieces.polygon[row++] = static_cast<int>(p);
            }
        }
    }
    return pieces;
}

PlacedMesh place_mesh(PointsIn points, const Eigen::Ref<const LongQuads>& faces,
                      const Eigen::Matrix4d& metres_from_object) {
    const Eigen::Matrix3d linear = metres_from_object.topLeftCorner<3, 3>();
    const double volume = linear.determinant();
    if (!metres_from_object.allFinite() || !(std::abs(volume) >= kNothing)) {
        throw InvalidInput("the object is scaled to nothing: apply its scale (Ctrl A)");
    }
    PlacedMesh placed{Points(points.rows(), 3), faces, linear.inverse()};
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const Eigen::Vector3d point = points.row(v);
        placed.vertices.row(v) = (linear * point + metres_from_object.topRightCorner<3, 1>()).transpose();
    }
    if (volume < 0) {
        for (Eigen::Index f = 0; f < faces.rows(); ++f) {
            const Eigen::Index count = faces(f, 3) < 0 ? 3 : 4;
            placed.faces.row(f).head(count) = faces.row(f).head(count).reverse();
        }
    }
    return placed;
}

}  // namespace mimetic
