// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/solve/solve.hpp>
#include <string>
#include <vector>

namespace mimetic {

using FloatPoints = Rows<float, 3>;
using FloatPixels = Rows<float, 2>;

/// A point fixed to the skin, and how it moves with the values.
struct SkinPoint {
    Eigen::Vector3f neutral;
    Eigen::Matrix3Xf modes;         ///< 3 x M
    Eigen::Matrix3Xf detail_modes;  ///< 3 x D
};

/// The refined skin with its modes carried over from the control vertices, head frame, metres.
class FaceSurface {
public:
    FaceSurface(const TrackedSurface& surface, const FaceMotion& motion);

    void evaluate(const Eigen::VectorXd& values, FloatPoints& points) const;
    SkinPoint at(int triangle, const Eigen::Vector3f& barycentric) const;
    /// The limit of a control vertex, which is the refined vertex of the same number.
    SkinPoint at_vertex(int vertex) const;
    const Triangles& triangles() const { return triangles_; }
    const Eigen::VectorXf& weights() const { return weights_; }
    const std::vector<Points>& rims() const { return rims_; }
    int num_values() const { return static_cast<int>(modes_.cols()); }

private:
    Triangles triangles_;
    Eigen::VectorXf weights_;       // R
    std::vector<Points> rims_;      // of glasses
    Eigen::VectorXf neutral_;       // 3R
    Eigen::MatrixXf modes_;         // 3R x M
    Eigen::MatrixXf detail_modes_;  // 3R x D
};

/// Refined vertices in an image; depth is z, and what lies behind the camera has depth 0.
struct ProjectedSurface {
    FloatPixels pixels;
    Eigen::VectorXf depths;
    FloatPoints points_in_head;

    void update(const FaceSurface& surface, const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                const Eigen::VectorXd& values);
};

/// A small picture of an image: its pixel (x, y) is the image's (x, y) / scale + origin.
struct RasterGrid {
    Eigen::Vector2d origin = Eigen::Vector2d::Zero();
    double scale = 1;
    int rows = 0;
    int cols = 0;
};

/// Which triangle each pixel of a small picture sees.
void raster_surface(const ProjectedSurface& projected, const Triangles& triangles, const RasterGrid& grid,
                    Raster& raster);

}  // namespace mimetic
