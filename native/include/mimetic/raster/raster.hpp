// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

template <typename Scalar>
using TriangleCorners = std::array<Eigen::Matrix<Scalar, 2, 1>, 3>;  ///< pixels

/// Twice a triangle's area, positive from x to y.
template <typename Scalar>
Scalar doubled_area(const TriangleCorners<Scalar>& corners) {
    const auto first = corners[1] - corners[0], second = corners[2] - corners[0];
    return first.x() * second.y() - first.y() * second.x();
}

/// Barycentric coordinates of a pixel, sum 1, below 0 outside; false when the triangle has no area.
template <typename Scalar>
bool barycentric_of(const Eigen::Matrix<Scalar, 2, 1>& pixel, const TriangleCorners<Scalar>& corners,
                    Eigen::Matrix<Scalar, 3, 1>& weights) {
    const Scalar area = doubled_area(corners);
    if (!(std::abs(area) > Scalar(1e-12))) {
        return false;
    }
    weights[1] = doubled_area<Scalar>({corners[0], pixel, corners[2]}) / area;
    weights[2] = doubled_area<Scalar>({corners[0], corners[1], pixel}) / area;
    weights[0] = 1 - weights[1] - weights[2];
    return true;
}

/// Calls visit(x, y, weights) for each pixel of a rows x cols picture whose centre lies in the triangle.
/// slack: by how much a weight may be below 0, so that rounding leaves no gap between neighbours.
template <typename Scalar, typename Visit>
void fill_triangle(const TriangleCorners<Scalar>& corners, int rows, int cols, Visit&& visit,
                   Scalar slack = 0) {
    using Pixel = Eigen::Matrix<Scalar, 2, 1>;
    const Pixel low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    const Pixel high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    const auto clamped = [](Scalar value, int limit) {
        return static_cast<int>(std::clamp(value, Scalar(0), static_cast<Scalar>(limit)));
    };
    const int x_end = clamped(std::floor(high.x()) + 1, cols);
    const int y_end = clamped(std::floor(high.y()) + 1, rows);
    Eigen::Matrix<Scalar, 3, 1> weights;
    for (int y = clamped(std::ceil(low.y()), rows); y < y_end; ++y) {
        for (int x = clamped(std::ceil(low.x()), cols); x < x_end; ++x) {
            const Pixel pixel(static_cast<Scalar>(x), static_cast<Scalar>(y));
            if (barycentric_of(pixel, corners, weights) && weights.minCoeff() >= -slack) {
                visit(x, y, weights);
            }
        }
    }
}

/// The nearest surface behind each pixel of a picture.
struct Raster {
    int rows = 0;
    int cols = 0;
    std::vector<int> face;     ///< rows x cols; -1: none
    std::vector<float> depth;  ///< of the face; infinity: none

    Raster() = default;
    Raster(int num_rows, int num_cols) { clear(num_rows, num_cols); }

    void clear(int num_rows, int num_cols);

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(x);
    }

    /// Takes the face where it is nearer than what is there; true if it was.
    bool keep_nearer(int x, int y, int new_face, float new_depth) {
        const std::size_t at = index(x, y);
        if (!(new_depth < depth[at])) {
            return false;
        }
        depth[at] = new_depth;
        face[at] = new_face;
        return true;
    }
};

/// The quad that each pixel shows, of quads in the plane of the picture.
struct QuadRaster {
    Raster raster;
    Rows<float, 4> weights;  ///< a row a pixel: weights of the quad's corners, 0 where there is none
};

/// Quads (Q x 4) of corners with a pixel and a height each: where several cover a pixel's centre, the highest
/// is seen. A quad is two triangles, as in all pictures of a surface. Throws InvalidInput on an index out of
/// range, or a corner that is not finite.
QuadRaster raster_quads(Points2In pixels, VectorIn heights, QuadsIn quads, int rows, int cols);

}  // namespace mimetic
