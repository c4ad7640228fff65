// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// The triangle that a ray meets first.
struct RayHit {
    int triangle = -1;                                  ///< -1: none
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of its corners; 0 where there is none
};

/// Finds the triangle that a ray through a place of a plane meets, among those that face the viewer. They
/// are sorted into cells of the plane, so that few are tested per ray.
class RayCaster {
public:
    /// Rays through pixels of a camera. vertices_in_camera: V x 3, metres; triangles: T x 3,
    /// counter-clockwise seen from outside; pixels: those that will be queried. Throws InvalidInput on an
    /// index out of range, or a pixel that is not finite.
    RayCaster(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles, Points2In pixels);

    /// Rays along y through places (x, z), for triangles that face up, or down. Of several that a ray meets
    /// the first in the list counts.
    enum class Facing { up, down };
    RayCaster(PointsIn vertices, TrianglesIn triangles, Facing facing);

    RayHit at(const Eigen::Vector2d& place) const;

private:
    /// A projected triangle. The ray s r meets its plane where the corners' weights solve s r = u a + v b
    /// + w c; each is a triple product with the ray, and before scaling they sum to 1 / s. For parallel rays
    /// they sum to 1.
    struct Facet {
        int triangle = 0;
        Eigen::Matrix3d planes;  ///< a row a corner
        Eigen::Vector2d low, high;
    };

    void lay_out(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double least_side, int most_cells);
    std::size_t cell_of(const Eigen::Vector2d& place) const;

    bool is_parallel_ = false;
    Camera camera_;
    std::vector<Facet> facets_;
    Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
    double side_ = 1;
    Eigen::Index columns_ = 1, rows_ = 1;
    std::vector<std::vector<int>> cells_;  ///< facets by cell of the plane
};

/// Where the rays of K pixels meet triangles first.
struct RayHits {
    Eigen::VectorXi triangle;  ///< K; -1: none
    Points weights;            ///< K x 3, of the triangle's corners; 0 where there is none
};

/// The nearest triangle under each pixel among those that face the camera and are in front of it.
/// vertices_in_camera: V x 3, metres; triangles: T x 3, counter-clockwise seen from outside. Throws
/// InvalidInput on an index out of range.
RayHits cast_rays(const Camera& camera, PointsIn vertices_in_camera, TrianglesIn triangles, Points2In pixels);

/// Cosine between a triangle's normal and the way to the camera from a point; metres, camera frame.
double facing_cosine(PointsIn vertices_in_camera, const Eigen::RowVector3i& triangle,
                     const Eigen::Vector3d& at);

}  // namespace mimetic
