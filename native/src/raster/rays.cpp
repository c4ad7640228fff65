// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/raster/rays.hpp>
#include <mimetic/shared/error.hpp>
#include <string>
#include <vector>

namespace mimetic {
namespace {

constexpr double kNearest = 1e-3;  // metres
constexpr double kTile = 16;       // pixels
constexpr double kOnEdge = 1e-9;   // of a triangle's weights
constexpr Eigen::Index kSide =
    512;  // tiles at most along a side: a triangle beside the picture may be far away

/// A triangle seen from the camera. The ray s r meets its plane where the corners' weights solve s r = u a +
/// v b + w c; each is a triple product with the ray, and before scaling they sum to 1 / s.
struct Facet {
    int triangle = 0;
    Eigen::Matrix3d planes;  ///< a row a corner
    Eigen::Vector2d low, high;
};

std::vector<Facet> facets_of(const Camera& camera, PointsIn vertices, TrianglesIn triangles) {
    std::vector<Facet> facets;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                              c = vertices.row(triangles(t, 2));
        if (!(std::min({a.z(), b.z(), c.z()}) > kNearest) || !((b - a).cross(c - a).dot(a) < 0)) {
            continue;
        }
        Facet facet;
        facet.triangle = static_cast<int>(t);
        facet.planes << b.cross(c).transpose(), c.cross(a).transpose(), a.cross(b).transpose();
        facet.planes /= a.dot(b.cross(c));
        const Eigen::Vector2d shown[] = {camera.project(a), camera.project(b), camera.project(c)};
        facet.low = shown[0].cwiseMin(shown[1]).cwiseMin(shown[2]);
        facet.high = shown[0].cwiseMax(shown[1]).cwiseMax(shown[2]);
        facets.push_back(facet);
    }
    return facets;
}

/// Facets by the tiles of the picture that they touch, about the pixels that are asked for.
class Tiles {
public:
    Tiles(const std::vector<Facet>& facets, Points2In pixels) {
        origin_ = pixels.colwise().minCoeff().transpose();
        const Eigen::Vector2d size = pixels.colwise().maxCoeff().transpose() - origin_;
        side_ = std::max(kTile, size.maxCoeff() / static_cast<double>(kSide - 1));
        columns_ = 1 + static_cast<Eigen::Index>(size.x() / side_);
        rows_ = 1 + static_cast<Eigen::Index>(size.y() / side_);
        tiles_.resize(static_cast<std::size_t>(columns_ * rows_));
        for (std::size_t f = 0; f < facets.size(); ++f) {
            const Eigen::Vector2d low = (facets[f].low - origin_) / side_,
                                  high = (facets[f].high - origin_) / side_;
            if (high.minCoeff() < 0 || !(low.x() < double(columns_)) || !(low.y() < double(rows_))) {
                continue;
            }
            for (Eigen::Index y = place(low.y(), rows_); y <= place(high.y(), rows_); ++y) {
                for (Eigen::Index x = place(low.x(), columns_); x <= place(high.x(), columns_); ++x) {
                    tiles_[static_cast<std::size_t>(y * columns_ + x)].push_back(static_cast<int>(f));
                }
            }
        }
    }

    const std::vector<int>& under(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector2d at = (pixel - origin_) / side_;
        return tiles_[static_cast<std::size_t>(place(at.y(), rows_) * columns_ + place(at.x(), columns_))];
    }

private:
    static Eigen::Index place(double at, Eigen::Index count) {
        return static_cast<Eigen::Index>(std::clamp(at, 0., static_cast<double>(count - 1)));
    }

    Eigen::Vector2d origin_;
    double side_ = kTile;
    Eigen::Index columns_ = 1, rows_ = 1;
    std::vector<std::vector<int>> tiles_;
};

}  // namespace

RayHits cast_rays(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles,
                  Points2In pixels) {
    if (triangles.size() > 0 &&
        (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices_in_camera.rows())) {
        throw InvalidInput("a triangle names a vertex outside 0 to " +
                           std::to_string(vertices_in_camera.rows() - 1));
    }
    RayHits hits{Eigen::VectorXi::Constant(pixels.rows(), -1), Points::Zero(pixels.rows(), 3)};
    if (pixels.rows() == 0) {
        return hits;
    }
    if (!pixels.allFinite()) {
        throw InvalidInput("a pixel whose ray is asked for is not finite");
    }
    const std::vector<Facet> facets = facets_of(camera, vertices_in_camera, triangles);
    const Tiles tiles(facets, pixels);
    for (Eigen::Index k = 0; k < pixels.rows(); ++k) {
        const Eigen::Vector3d ray((pixels(k, 0) - camera.cx) / camera.fx,
                                  (pixels(k, 1) - camera.cy) / camera.fy, 1);
        double nearest = 0;  // 1 / s
        for (const int f : tiles.under(pixels.row(k).transpose())) {
            const Facet& facet = facets[static_cast<std::size_t>(f)];
            const Eigen::Vector3d parts = facet.planes * ray;
            const double total = parts.sum();
            if (std::isfinite(total) && total > nearest && parts.minCoeff() >= -kOnEdge * total) {
                nearest = total;
                hits.triangle[k] = facet.triangle;
                hits.weights.row(k) = parts.transpose() / total;
            }
        }
    }
    return hits;
}

double facing_cosine(PointsIn vertices_in_camera, const Eigen::RowVector3i& triangle,
                     const Eigen::Vector3d& at) {
    const Eigen::Vector3d a = vertices_in_camera.row(triangle[0]), b = vertices_in_camera.row(triangle[1]),
                          c = vertices_in_camera.row(triangle[2]);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    return -normal.dot(at) / (normal.norm() * at.norm() + 1e-30);
}

}  // namespace mimetic
