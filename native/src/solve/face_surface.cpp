// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_surface.hpp"

#include <mimetic/surface/surface.hpp>

namespace mimetic {

TrackedSurface refine_for_tracking(QuadsIn faces, VectorIn vertex_weights, int levels,
                                   std::vector<Points> rims) {
    const SubdividedMesh mesh(faces, static_cast<int>(vertex_weights.size()), levels);
    return {mesh.stencils(), mesh.faces(), (mesh.stencils() * vertex_weights).cwiseMax(0).cwiseMin(1),
            std::move(rims)};
}

FaceSurface::FaceSurface(const TrackedSurface& surface, const FaceMotion& motion)
    : triangles_(2 * surface.quads.rows(), 3), weights_(surface.weights.cast<float>()), rims_(surface.rims) {
    const Eigen::Index num_vertices = motion.neutral.rows();
    const Eigen::Index num_refined = surface.stencils.rows();
    for (Eigen::Index face = 0; face < surface.quads.rows(); ++face) {
        const auto quad = surface.quads.row(face);
        for (Eigen::Index half = 0; half < 2; ++half) {
            const auto& [a, b, c] = kQuadHalves[static_cast<std::size_t>(half)];
            triangles_.row(2 * face + half) << quad[a], quad[b], quad[c];
        }
    }
    Points refined = surface.stencils * motion.neutral;
    neutral_ = Eigen::Map<const Eigen::VectorXd>(refined.data(), 3 * num_refined).cast<float>();
    const auto refine = [&](const MatrixRows& modes) {
        Eigen::MatrixXf columns(3 * num_refined, modes.rows());
        for (Eigen::Index mode = 0; mode < modes.rows(); ++mode) {
            refined = surface.stencils * Eigen::Map<const Points>(modes.row(mode).data(), num_vertices, 3);
            columns.col(mode) =
                Eigen::Map<const Eigen::VectorXd>(refined.data(), 3 * num_refined).cast<float>();
        }
        return columns;
    };
    modes_ = refine(motion.modes);
    detail_modes_ = refine(motion.detail_modes);
}

void FaceSurface::evaluate(const Eigen::VectorXd& values, FloatPoints& points) const {
    points.resize(neutral_.size() / 3, 3);
    Eigen::Map<Eigen::VectorXf> flat(points.data(), neutral_.size());
    constexpr Eigen::Index kBlock = 2048;  // stays in the cache while the modes pass by
    for (Eigen::Index start = 0; start < flat.size(); start += kBlock) {
        const Eigen::Index size = std::min(kBlock, flat.size() - start);
        auto block = flat.segment(start, size);
        block = neutral_.segment(start, size);
        for (Eigen::Index mode = 0; mode < values.size(); ++mode) {
            if (values[mode] != 0) {
                block += static_cast<float>(values[mode]) * modes_.col(mode).segment(start, size);
            }
        }
    }
}

SkinPoint FaceSurface::at(int triangle, const Eigen::Vector3f& barycentric) const {
    SkinPoint point{Eigen::Vector3f::Zero(), Eigen::Matrix3Xf::Zero(3, modes_.cols()),
                    Eigen::Matrix3Xf::Zero(3, detail_modes_.cols())};
    for (int corner = 0; corner < 3; ++corner) {
        const int vertex = triangles_(triangle, corner);
        point.neutral += barycentric[corner] * neutral_.segment<3>(3 * vertex);
        point.modes += barycentric[corner] * modes_.middleRows<3>(3 * vertex);
        point.detail_modes += barycentric[corner] * detail_modes_.middleRows<3>(3 * vertex);
    }
    return point;
}

SkinPoint FaceSurface::at_vertex(int vertex) const {
    return {neutral_.segment<3>(3 * vertex), modes_.middleRows<3>(3 * vertex),
            detail_modes_.middleRows<3>(3 * vertex)};
}

void ProjectedSurface::update(const FaceSurface& surface, const Camera& camera,
                              const Eigen::Isometry3d& camera_from_head, const Eigen::VectorXd& values) {
    surface.evaluate(values, points_in_head);
    const Eigen::Index count = points_in_head.rows();
    pixels.resize(count, 2);
    depths.resize(count);
    const Eigen::Matrix3f rotation = camera_from_head.linear().cast<float>();
    const Eigen::Vector3f translation = camera_from_head.translation().cast<float>();
    const Eigen::Vector2f focal(static_cast<float>(camera.fx), static_cast<float>(camera.fy));
    const Eigen::Vector2f centre(static_cast<float>(camera.cx), static_cast<float>(camera.cy));
    constexpr float kNearest = 1e-2f;
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Vector3f point = rotation * points_in_head.row(i).transpose() + translation;
        const bool in_front = point.z() > kNearest;
        depths[i] = in_front ? point.z() : 0;
        pixels.row(i) = in_front
                            ? (focal.cwiseProduct(point.head<2>()) / point.z() + centre).eval().transpose()
                            : Eigen::RowVector2f(-1e6f, -1e6f);
    }
}

void raster_surface(const ProjectedSurface& projected, const Triangles& triangles, const RasterGrid& grid,
                    Raster& raster) {
    raster.clear(grid.rows, grid.cols);
    const Eigen::Vector2f offset = grid.origin.cast<float>();
    const auto factor = static_cast<float>(grid.scale);
    for (int index = 0; index < triangles.rows(); ++index) {
        TriangleCorners<float> corners;
        Eigen::Vector3f depths;
        for (int k = 0; k < 3; ++k) {
            const int vertex = triangles(index, k);
            corners[static_cast<std::size_t>(k)] =
                (projected.pixels.row(vertex).transpose() - offset) * factor;
            depths[k] = projected.depths[vertex];
        }
        // Counter-clockwise from outside turns clockwise as y points down.
        if (depths.minCoeff() > 0 && doubled_area(corners) < 0) {
            fill_triangle(corners, raster.rows, raster.cols,
                          [&](int x, int y, const Eigen::Vector3f& weights) {
                              const float depth =
                                  weights[0] * depths[0] + weights[1] * depths[1] + weights[2] * depths[2];
                              raster.keep_nearer(x, y, index, depth);
                          });
        }
    }
}

}  // namespace mimetic
