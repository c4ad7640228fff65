// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/raster/portrait.hpp>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

constexpr int kFiner = 3;  // samples a pixel on each axis, against steps at edges
constexpr double kAmbient = .3;

Points vertex_normals(PointsIn vertices, QuadsIn faces) {
    Points normals = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Eigen::Vector3d one = vertices.row(faces(f, 2)) - vertices.row(faces(f, 0));
        const Eigen::Vector3d other = vertices.row(faces(f, 3)) - vertices.row(faces(f, 1));
        const Eigen::Vector3d normal = one.cross(other);
        for (int k = 0; k < 4; ++k) {
            normals.row(faces(f, k)) += normal.transpose();
        }
    }
    return normals;
}

Quads drawn_faces(QuadsIn faces, PointsIn colours, std::vector<Eigen::Index>& rows) {
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        if (colours.row(f).minCoeff() >= 0) {
            rows.push_back(f);
        }
    }
    Quads drawn(static_cast<Eigen::Index>(rows.size()), 4);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        drawn.row(static_cast<Eigen::Index>(i)) = faces.row(rows[i]);
    }
    return drawn;
}

}  // namespace

void PortraitOptions::check() const {
    check_range("PortraitOptions.size", size, 16, 2048);
    check_range("PortraitOptions.middle_x", middle_x, -10, 10);
    check_range("PortraitOptions.middle_y", middle_y, -10, 10);
    check_range("PortraitOptions.height", height, .01, 10);
}

std::vector<std::uint8_t> draw_portrait(PointsIn vertices, QuadsIn faces, PointsIn colours,
                                        const PortraitOptions& options) {
    options.check();
    require(colours.rows() == faces.rows() && colours.allFinite(), "a portrait needs a colour for each face");
    require(faces.size() == 0 || (faces.minCoeff() >= 0 && faces.maxCoeff() < vertices.rows()),
            "a portrait's faces name vertices that do not exist");
    const int fine = kFiner * options.size;
    const double scale = fine / options.height;
    Points2 pixels(vertices.rows(), 2);
    pixels.col(0) = (vertices.col(0).array() - options.middle_x) * scale + .5 * (fine - 1);
    pixels.col(1) = (options.middle_y - vertices.col(1).array()) * scale + .5 * (fine - 1);
    std::vector<Eigen::Index> rows;
    const Quads drawn = drawn_faces(faces, colours, rows);
    const QuadRaster seen = raster_quads(pixels, vertices.col(2), drawn, fine, fine);
    const Points normals = vertex_normals(vertices, drawn);
    const Eigen::Vector3d light = Eigen::Vector3d(.35, .45, .82).normalized();
    std::vector<Eigen::Vector4d> sums(static_cast<std::size_t>(options.size * options.size),
                                      Eigen::Vector4d::Zero());
    for (int y = 0; y < fine; ++y) {
        for (int x = 0; x < fine; ++x) {
            const std::size_t at = seen.raster.index(x, y);
            const int quad = seen.raster.face[at];
            if (quad < 0) {
                continue;
            }
            Eigen::Vector3d normal = Eigen::Vector3d::Zero();
            for (int k = 0; k < 4; ++k) {
                normal += static_cast<double>(seen.weights(static_cast<Eigen::Index>(at), k)) *
                          normals.row(drawn(quad, k)).transpose();
            }
            const double shade = kAmbient + (1 - kAmbient) * std::max(0., normal.normalized().dot(light));
            Eigen::Vector4d& sum = sums[static_cast<std::size_t>(y / kFiner * options.size + x / kFiner)];
            sum.head<3>() += shade * colours.row(rows[static_cast<std::size_t>(quad)]).transpose();
            sum[3] += 1;
        }
    }
    std::vector<std::uint8_t> picture;
    picture.reserve(4 * sums.size());
    for (const Eigen::Vector4d& sum : sums) {
        const double count = std::max(1., sum[3]);
        for (int k = 0; k < 4; ++k) {
            const double value = k < 3 ? sum[k] / count : sum[3] / (kFiner * kFiner);
            picture.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0., 1.))));
        }
    }
    return picture;
}

}  // namespace mimetic
