// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/raster/depth.hpp>
#include <mimetic/raster/raster.hpp>
#include <mimetic/raster/texture.hpp>
#include <mimetic/shared/error.hpp>
#include <string>
#include <utility>
#include <vector>

#include "shared/colour_at.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

constexpr double kBehind = .006;               // metres under the nearest surface that are hidden
constexpr double kGrazing = .2, kFacing = .5;  // cosine to the viewer: no colour below, all of it above
constexpr double kPlacesPerTexel = 1.5;        // along a side of a face, that none is left out
constexpr double kSeen = .5;                   // weight from which a texel's colour is the frame's

/// A square picture of colours, premultiplied by the weight in the last column; size^2 x 4.
using Weighted = Rows<double, 4>;

/// The point that each texel shows, of the faces that have a vertex of weight above 0.
QuadRaster lay_out(const TextureLayout& layout, VectorIn vertex_weights) {
    const Eigen::Index count = layout.corners.rows();
    Points2 texels(count, 2);
    texels.col(0) = layout.corners.col(0).array() * layout.size - .5;
    texels.col(1) = (1 - layout.corners.col(1).array()) * layout.size - .5;
    Quads quads(count / 4, 4);
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        double highest = 0;
        for (int k = 0; k < 4; ++k) {
            highest = std::max(highest, vertex_weights[layout.faces(f, k)]);
            quads(f, k) = static_cast<int>(4 * f + k);
        }
        if (!(highest > 0)) {
            quads.row(f).setConstant(quads(f, 0));  // has no area: keeps the faces' numbers, shows nowhere
        }
    }
    return raster_quads(texels, Eigen::VectorXd::Zero(count), quads, layout.size, layout.size);
}

/// How much of a colour is taken from skin that is turned from the viewer.
double facing_weight(const Eigen::Vector3d& normal, const Eigen::Vector3d& at) {
    const double cosine = -normal.dot(at) / at.norm();
    const double ramp = std::clamp((cosine - kGrazing) / (kFacing - kGrazing), 0., 1.);
    return ramp * ramp * (3 - 2 * ramp);
}

/// Half the size: weights are summed, up to 1.
Weighted halved(const Weighted& fine, Eigen::Index size) {
    const Eigen::Index half = size / 2;
    Weighted coarse(half * half, 4);
    for (Eigen::Index y = 0; y < half; ++y) {
        for (Eigen::Index x = 0; x < half; ++x) {
            const Eigen::Index at = 2 * y * size + 2 * x;
            const Eigen::RowVector4d sum =
                fine.row(at) + fine.row(at + 1) + fine.row(at + size) + fine.row(at + size + 1);
            coarse.row(y * half + x) = sum / std::max(sum[3], 1.);
        }
    }
    return coarse;
}

/// Twice the size, without blocks: a quarter comes from the neighbour, round the edges too.
Points doubled(const Points& coarse, Eigen::Index size) {
    const auto other = [size](Eigen::Index at) {  // of a texel of the fine picture, along a side
        return (at / 2 + (at % 2 ? 1 : size - 1)) % size;
    };
    Points fine(4 * size * size, 3);
    for (Eigen::Index y = 0; y < 2 * size; ++y) {
        for (Eigen::Index x = 0; x < 2 * size; ++x) {
            const auto along = [&](Eigen::Index row) -> Eigen::RowVector3d {
                return .75 * coarse.row(row * size + x / 2) + .25 * coarse.row(row * size + other(x));
            };
            fine.row(y * 2 * size + x) = .75 * along(y / 2) + .25 * along(other(y));
        }
    }
    return fine;
}

/// Fills what has little weight from its surroundings, coarse to fine [Gortler et al. 1996].
Points filled(Weighted texture, Eigen::Index size) {
    std::vector<Weighted> levels{std::move(texture)};
    for (Eigen::Index side = size; side > 1; side /= 2) {
        levels.push_back(halved(levels.back(), side));
    }
    Points colours = levels.back().leftCols<3>() / std::max(levels.back()(0, 3), 1e-12);
    Eigen::Index side = 1;
    for (std::size_t k = levels.size() - 1; k-- > 0; side *= 2) {
        const Points under = doubled(colours, side);
        const Eigen::ArrayXd open = 1 - levels[k].col(3).array().cwiseMin(1);
        colours = levels[k].leftCols<3>() + (under.array().colwise() * open).matrix();
    }
    return colours;
}

}  // namespace

void TextureLayout::check(Eigen::Index num_vertices) const {
    check_image_size(size, size, "texture");
    if (corners.rows() != 4 * faces.rows()) {
        throw InvalidInput("each face of a texture needs four corners");
    }
    if (!corners.allFinite()) {
        throw InvalidInput("a corner of a texture is not finite");
    }
    if (faces.size() > 0 && (faces.minCoeff() < 0 || faces.maxCoeff() >= num_vertices)) {
        throw InvalidInput("a face of a texture names a vertex outside 0 to " +
                           std::to_string(num_vertices - 1));
    }
}

MatrixRows unwrap_values(const TextureLayout& layout, MatrixIn values) {
    layout.check(values.rows());
    if (layout.corners.size() > 0 && (layout.corners.minCoeff() < 0 || layout.corners.maxCoeff() > 1)) {
        throw InvalidInput("a corner of a texture is outside 0 to 1");
    }
    const Eigen::Index size = layout.size;
    MatrixRows sums = MatrixRows::Zero(size * size, values.cols());
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(size * size);
    const auto texel_of = [size](double coordinate) {
        return static_cast<Eigen::Index>(std::min(coordinate, 1 - 1e-9) * static_cast<double>(size));
    };
    MatrixRows of_corners(4, values.cols());
    for (Eigen::Index f = 0; f < layout.faces.rows(); ++f) {
        const Eigen::Matrix<double, 4, 2> corners = layout.corners.middleRows<4>(4 * f);
        for (int k = 0; k < 4; ++k) {
            of_corners.row(k) = values.row(layout.faces(f, k));
        }
        const double extent = (corners.colwise().maxCoeff() - corners.colwise().minCoeff()).maxCoeff();
        const int steps = static_cast<int>(extent * layout.size * kPlacesPerTexel) + 1;
        for (int i = 0; i <= steps; ++i) {
            for (int j = 0; j <= steps; ++j) {
                const double s = static_cast<double>(j) / steps, t = static_cast<double>(i) / steps;
                const Eigen::RowVector4d shares((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t);
                const Eigen::RowVector2d place = shares * corners;
                const Eigen::Index texel = (size - 1 - texel_of(place.y())) * size + texel_of(place.x());
                sums.row(texel) += shares * of_corners;
                ++counts[texel];
            }
        }
    }
    return sums.array().colwise() / counts.array().max(1);
}

ProjectedTexture project_texture(const Camera& camera, const ColorView& image, PointsIn vertices_in_camera,
                                 PointsIn normals, const TextureLayout& layout, VectorIn vertex_weights) {
    const Eigen::Index num_vertices = vertices_in_camera.rows(), size = layout.size;
    layout.check(num_vertices);
    if ((size & (size - 1)) != 0) {
        throw InvalidInput("a texture's side is " + std::to_string(size) + " texels, no power of two");
    }
    if (vertex_weights.size() != num_vertices || normals.rows() != num_vertices) {
        throw InvalidInput("a texture needs a normal and a weight for each vertex");
    }
    if (image.cols != camera.width || image.rows != camera.height) {
        throw InvalidInput("the frame must have the camera's size");
    }
    const DepthMap depth = render_depth(camera, vertices_in_camera, layout.faces);
    const QuadRaster laid = lay_out(layout, vertex_weights);
    Weighted sums = Weighted::Zero(size * size, 4);
    std::array<std::vector<double>, 3> seen;
    for (Eigen::Index texel = 0; texel < sums.rows(); ++texel) {
        const int face = laid.raster.face[static_cast<std::size_t>(texel)];
        if (face < 0) {
            continue;
        }
        Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
        double wanted = 0;
        for (int k = 0; k < 4; ++k) {
            const double share = static_cast<double>(laid.weights(texel, k));
            const int vertex = layout.faces(face, k);
            point += share * vertices_in_camera.row(vertex).transpose();
            normal += share * normals.row(vertex).transpose();
            wanted += share * vertex_weights[vertex];
        }
        if (!depth.shows(camera, point, kBehind)) {
            continue;
        }
        const double weight = wanted * facing_weight(normal, point);
        const Eigen::Vector3d colour = colour_at(image, camera.project(point));
        sums.row(texel) << weight * colour.transpose(), weight;
        for (std::size_t channel = 0; weight > kSeen && channel < 3; ++channel) {
            seen[channel].push_back(colour[static_cast<Eigen::Index>(channel)]);
        }
    }
    if (seen[0].empty()) {
        throw InvalidInput("the face is outside the picture in the frame chosen for its texture");
    }
    const Points colours = filled(std::move(sums), size);
    ProjectedTexture projected{{layout.size, layout.size, {}},
                               {median(seen[0]), median(seen[1]), median(seen[2])}};
    projected.texture.pixels.reserve(static_cast<std::size_t>(colours.size()));
    for (Eigen::Index i = 0; i < colours.size(); ++i) {
        const double level = std::clamp(colours.data()[i] + .5, 0., 255.);
        projected.texture.pixels.push_back(static_cast<std::uint8_t>(level));
    }
    return projected;
}

}  // namespace mimetic
