// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/head/model_mesh.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>

namespace mimetic {
namespace {

constexpr int kMeridians = 32, kParallels = 16;   // of a whole ellipsoid
constexpr int kRings = 6;                         // of the planar patch
constexpr double kInnermost = .02;                // of the patch's radius
constexpr double kPole = .49 * std::numbers::pi;  // no quad without area

/// Elevation on a unit sphere of a height in metres.
double elevation(const HeadShape& shape, double height) {
    const double up = (height - shape.centre.y()) / shape.half_axes.y();
    return std::clamp(std::asin(std::clamp(up, -1., 1.)), -kPole, kPole);
}

}  // namespace

ModelMesh mesh_of_model(const HeadShape& shape, double lowest, double highest) {
    if (shape.model == HeadModel::surface) {
        throw InvalidInput("a model that is a surface has vertices of its own to draw");
    }
    const bool is_plane = shape.model == HeadModel::plane;
    const int rings = is_plane ? kRings : kParallels;
    const double low = elevation(shape, lowest), high = elevation(shape, highest);
    ModelMesh mesh{Points((rings + 1) * kMeridians, 3), Quads(rings * kMeridians, 4)};
    for (int ring = 0; ring <= rings; ++ring) {
        const double part = static_cast<double>(ring) / rings;
        const double radius = 1 - (1 - kInnermost) * part, up = low + (high - low) * part;
        for (int k = 0; k < kMeridians; ++k) {
            const double around = 2 * std::numbers::pi * k / kMeridians;
            const Eigen::Vector3d place =
                is_plane ? Eigen::Vector3d(radius * std::cos(around), radius * std::sin(around), 0)
                         : Eigen::Vector3d(std::cos(up) * std::sin(around), std::sin(up),
                                           std::cos(up) * std::cos(around));
            const int row = ring * kMeridians + k, beside = ring * kMeridians + (k + 1) % kMeridians;
            mesh.vertices.row(row) =
                (shape.centre + shape.turn * place.cwiseProduct(shape.half_axes)).transpose();
            if (ring < rings) {
                mesh.faces.row(row) << row, beside, beside + kMeridians, row + kMeridians;
            }
        }
    }
    return mesh;
}

}  // namespace mimetic
