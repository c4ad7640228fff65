// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic {

void Raster::clear(int num_rows, int num_cols) {
    rows = num_rows;
    cols = num_cols;
    const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
    face.assign(count, -1);
    depth.assign(count, std::numeric_limits<float>::infinity());
}

QuadRaster raster_quads(Points2In pixels, VectorIn heights, QuadsIn quads, int rows, int cols) {
    check_image_size(rows, cols, "picture");
    if (heights.size() != pixels.rows()) {
        throw InvalidInput("there are " + std::to_string(heights.size()) + " heights for " +
                           std::to_string(pixels.rows()) + " corners");
    }
    if (!pixels.allFinite() || !heights.allFinite()) {
        throw InvalidInput("a corner of the quads is not finite");
    }
    if (quads.size() > 0 && (quads.minCoeff() < 0 || quads.maxCoeff() >= pixels.rows())) {
        throw InvalidInput("a quad names a corner outside 0 to " + std::to_string(pixels.rows() - 1));
    }
    QuadRaster seen{Raster(rows, cols), Rows<float, 4>::Zero(Eigen::Index{rows} * cols, 4)};
    for (Eigen::Index q = 0; q < quads.rows(); ++q) {
        for (const std::array<int, 3>& half : kQuadHalves) {
            TriangleCorners<double> corners;
            Eigen::Vector3d depths;
            for (std::size_t k = 0; k < 3; ++k) {
                const int corner = quads(q, half[k]);
                corners[k] = pixels.row(corner);
                depths[static_cast<Eigen::Index>(k)] = -heights[corner];
            }
            fill_triangle(corners, rows, cols, [&](int x, int y, const Eigen::Vector3d& weights) {
                if (seen.raster.keep_nearer(x, y, static_cast<int>(q),
                                            static_cast<float>(weights.dot(depths)))) {
                    auto row = seen.weights.row(static_cast<Eigen::Index>(seen.raster.index(x, y)));
                    row.setZero();
                    for (std::size_t k = 0; k < 3; ++k) {
                        row[half[k]] = static_cast<float>(weights[static_cast<Eigen::Index>(k)]);
                    }
                }
            });
        }
    }
    return seen;
}

}  // namespace mimetic
