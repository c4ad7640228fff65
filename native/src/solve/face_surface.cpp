// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_surface.hpp"

#include <limits>
#include <mimetic/surface/surface.hpp>

namespace mimetic {

TrackedSurface refine_for_tracking(QuadsIn faces, VectorIn vertex_weights, int levels) {
    const SubdividedMesh mesh(faces, static_cast<int>(vertex_weights.size()), levels);
    return {mesh.stencils(), mesh.faces(), (mesh.stencils() * vertex_weights).cwiseMax(0).cwiseMin(1)};
}

FaceSurface::FaceSurface(const TrackedSurface& surface, const FaceMotion& motion)
    : triangles_(2 * surface.quads.rows(), 3), weights_(surface.weights.cast<float>()) {
    const Eigen::Index num_vertices = motion.neutral.rows();
    const Eigen::Index num_refined = surface.stencils.rows();
    for (Eigen::Index face = 0; face < surface.quads.rows(); ++face) {
        const auto quad = surface.quads.row(face);
        triangles_.row(2 * face) << quad[0], quad[1], quad[2];
        triangles_.row(2 * face + 1) << quad[0], quad[2], quad[3];
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

namespace {

struct Corner {
    Eigen::Vector2f pixel;
    float depth = 0;
};

void fill_triangle(SurfaceRaster& raster, const Corner corners[3], int triangle) {
    const Eigen::Vector2f low = corners[0].pixel.cwiseMin(corners[1].pixel).cwiseMin(corners[2].pixel);
    const Eigen::Vector2f high = corners[0].pixel.cwiseMax(corners[1].pixel).cwiseMax(corners[2].pixel);
    const auto clamped = [](float value, int limit) {
        return static_cast<int>(std::clamp(value, 0.f, static_cast<float>(limit)));
    };
    const int x_end = clamped(std::floor(high.x()) + 1, raster.cols);
    const int y_end = clamped(std::floor(high.y()) + 1, raster.rows);
    const Eigen::Vector2f pixels[3] = {corners[0].pixel, corners[1].pixel, corners[2].pixel};
    Eigen::Vector3f weights;
    for (int y = clamped(std::ceil(low.y()), raster.rows); y < y_end; ++y) {
        for (int x = clamped(std::ceil(low.x()), raster.cols); x < x_end; ++x) {
            if (!barycentric_of(Eigen::Vector2f(x, y), pixels, weights) || weights.minCoeff() < 0) {
                continue;
            }
            const float depth =
                weights[0] * corners[0].depth + weights[1] * corners[1].depth + weights[2] * corners[2].depth;
            const auto index = static_cast<std::size_t>(y) * raster.cols + x;
            if (depth < raster.depth[index]) {
                raster.depth[index] = depth;
                raster.triangle[index] = triangle;
            }
        }
    }
}

}  // namespace

bool barycentric_of(const Eigen::Vector2f& pixel, const Eigen::Vector2f corners[3],
                    Eigen::Vector3f& weights) {
    const Eigen::Vector2f first = corners[1] - corners[0];
    const Eigen::Vector2f second = corners[2] - corners[0];
    const float area = first.x() * second.y() - first.y() * second.x();
    if (std::abs(area) < 1e-12f) {
        return false;
    }
    const Eigen::Vector2f offset = pixel - corners[0];
    weights[1] = (offset.x() * second.y() - offset.y() * second.x()) / area;
    weights[2] = (first.x() * offset.y() - first.y() * offset.x()) / area;
    weights[0] = 1 - weights[1] - weights[2];
    return true;
}

void SurfaceRaster::update(const ProjectedSurface& projected, const Triangles& triangles,
                           const Eigen::Vector2d& origin, double scale, int num_rows, int num_cols) {
    rows = num_rows;
    cols = num_cols;
    triangle.assign(static_cast<std::size_t>(rows) * cols, -1);
    depth.assign(triangle.size(), std::numeric_limits<float>::infinity());
    const Eigen::Vector2f offset = origin.cast<float>();
    const auto factor = static_cast<float>(scale);
    for (int index = 0; index < triangles.rows(); ++index) {
        Corner corners[3];
        bool in_front = true;
        for (int k = 0; k < 3; ++k) {
            const int vertex = triangles(index, k);
            corners[k].pixel = (projected.pixels.row(vertex).transpose() - offset) * factor;
            corners[k].depth = projected.depths[vertex];
            in_front = in_front && corners[k].depth > 0;
        }
        const Eigen::Vector2f first = corners[1].pixel - corners[0].pixel;
        const Eigen::Vector2f second = corners[2].pixel - corners[0].pixel;
        // Counter-clockwise from outside turns clockwise as y points down.
        if (in_front && first.x() * second.y() - first.y() * second.x() < 0) {
            fill_triangle(*this, corners, index);
        }
    }
}

}  // namespace mimetic
