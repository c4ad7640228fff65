// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/fit/picture.hpp>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "shared/colour_at.hpp"

namespace mimetic {

namespace {

/// Corners of a quad, or their mean and normal (twice the area long).
struct Quad {
    std::array<Eigen::Vector3d, 4> corners;

    Quad(PointsIn vertices, const Eigen::RowVector4i& indices) {
        for (int c = 0; c < 4; ++c) {
            corners[static_cast<std::size_t>(c)] = vertices.row(indices[c]);
        }
    }
    Eigen::Vector3d normal() const { return (corners[2] - corners[0]).cross(corners[3] - corners[1]); }
    Eigen::Vector3d at(const Eigen::Vector4d& weights) const {
        return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2] +
               weights[3] * corners[3];
    }
};

void check_indices(QuadsIn quads, Eigen::Index num_vertices) {
    if (quads.size() > 0 && (quads.minCoeff() < 0 || quads.maxCoeff() >= num_vertices)) {
        throw InvalidInput("a quad names a vertex that is not one of " + std::to_string(num_vertices));
    }
}

/// To the nearest even where half-way.
Eigen::Matrix<std::uint8_t, 1, 3> rounded(const Eigen::Vector3d& colour) {
    Eigen::Matrix<std::uint8_t, 1, 3> levels;
    for (int channel = 0; channel < 3; ++channel) {
        const float value = std::nearbyint(static_cast<float>(colour[channel]));
        levels[channel] = static_cast<std::uint8_t>(std::clamp(value, 0.f, 255.f));
    }
    return levels;
}

/// Mean over squares of 2 reach + 1 pixels; the border is replicated.
cv::Mat1d box_mean(const cv::Mat1d& values, int reach) {
    cv::Mat1d mean;
    cv::blur(values, mean, {2 * reach + 1, 2 * reach + 1}, {-1, -1}, cv::BORDER_REPLICATE);
    return mean;
}

constexpr double kMargin = 1.04;  // of the face's height or width, whichever is larger
constexpr int kParts = 3;         // of a pixel of a canonical picture, along a side
// A pixel shows what is at its middle or else next to it: a slit between lips is no hole
constexpr std::array<int, kParts * kParts> kMiddleFirst = {4, 1, 3, 5, 7, 0, 2, 6, 8};

/// The quads that a canonical picture shows.
Quads shown_quads(PointsIn vertices, QuadsIn quads, const std::vector<bool>& is_hidden, double facing) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        bool is_shown = false;
        for (int k = 0; k < 4; ++k) {
            is_shown = is_shown || !is_hidden[static_cast<std::size_t>(quads(f, k))];
        }
        const Eigen::Vector3d normal = Quad(vertices, quads.row(f)).normal();
        if (is_shown && normal.z() > facing * (normal.norm() + 1e-30)) {
            rows.push_back(f);
        }
    }
    return quads(rows, Eigen::all);
}

/// Places in a picture of size x size that the quads' corners fill but for the margin; V x 2, pixels.
Points2 places_in_picture(PointsIn vertices, const Quads& quads, int size) {
    Eigen::RowVector2d low = Eigen::RowVector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::RowVector2d high = -low;
    for (const int vertex : quads.reshaped()) {
        low = low.cwiseMin(vertices.row(vertex).head<2>());
        high = high.cwiseMax(vertices.row(vertex).head<2>());
    }
    const double scale = size / (kMargin * (high - low).maxCoeff());
    const Eigen::RowVector2d middle = (low + high) / 2;
    return ((vertices.leftCols<2>().rowwise() - middle) * Eigen::Vector2d(scale, -scale).asDiagonal())
               .array() +
           (size - 1) / 2.;
}

}  // namespace

CanonicalPixels canonical_pixels(PointsIn vertices, QuadsIn quads, const std::vector<bool>& is_hidden,
                                 int size, double facing) {
    check_indices(quads, vertices.rows());
    if (static_cast<Eigen::Index>(is_hidden.size()) != vertices.rows()) {
        throw InvalidInput("a canonical picture needs to know of every vertex whether it is hidden");
    }
    check_image_size(size, size, "canonical picture");
    const Quads shown = shown_quads(vertices, quads, is_hidden, facing);
    if (shown.rows() == 0) {
        throw InvalidInput("no quad of the head faces the viewer of a canonical picture");
    }
    const Points2 parts = ((places_in_picture(vertices, shown, size).array() + .5) * kParts - .5).matrix();
    const QuadRaster fine = raster_quads(parts, vertices.col(2), shown, size * kParts, size * kParts);
    std::vector<int> pixels, part_seen;
    for (int pixel = 0; pixel < size * size; ++pixel) {
        for (const int part : kMiddleFirst) {
            const std::size_t at = fine.raster.index(pixel % size * kParts + part % kParts,
                                                     pixel / size * kParts + part / kParts);
            if (fine.raster.face[at] >= 0) {
                pixels.push_back(pixel);
                part_seen.push_back(static_cast<int>(at));
                break;
            }
        }
    }
    CanonicalPixels result;
    const auto count = static_cast<Eigen::Index>(pixels.size());
    result.pixel = Eigen::Map<const Eigen::VectorXi>(pixels.data(), count);
    result.corners.resize(count, 4);
    result.weights.resize(count, 4);
    for (Eigen::Index k = 0; k < count; ++k) {
        const int at = part_seen[static_cast<std::size_t>(k)];
        result.corners.row(k) = shown.row(fine.raster.face[static_cast<std::size_t>(at)]);
        result.weights.row(k) = fine.weights.row(at).cast<double>();
    }
    return result;
}

Edges facing_edges(PointsIn vertices_in_camera, QuadsIn quads, double facing) {
    check_indices(quads, vertices_in_camera.rows());
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index f = 0; f < quads.rows(); ++f) {
        const Quad quad(vertices_in_camera, quads.row(f));
        const Eigen::Vector3d normal = quad.normal(), middle = quad.at(Eigen::Vector4d::Constant(.25));
        if (-normal.dot(middle) > facing * std::max(normal.norm() * middle.norm(), 1e-12)) {
            for (int corner = 0; corner < 4; ++corner) {
                edges.insert(std::minmax({quads(f, corner), quads(f, (corner + 1) % 4)}));
            }
        }
    }
    Edges rows(static_cast<Eigen::Index>(edges.size()), 2);
    Eigen::Index i = 0;
    for (const auto& [a, b] : edges) {
        rows.row(i++) << a, b;
    }
    return rows;
}

SeenColours seen_colours(const ColorView& image, const Camera& camera, PointsIn vertices_in_camera,
                         const CanonicalPixels& pixels, double facing) {
    check_indices(pixels.corners, vertices_in_camera.rows());
    const Eigen::Index count = pixels.corners.rows();
    if (pixels.weights.rows() != count || image.cols != camera.width || image.rows != camera.height) {
        throw InvalidInput(
            "every pixel must have its corners and weights, and the picture the camera's size");
    }
    SeenColours seen{Rows<std::uint8_t, 3>::Zero(count, 3),
                     std::vector<bool>(static_cast<std::size_t>(count))};
    for (Eigen::Index k = 0; k < count; ++k) {
        const Quad quad(vertices_in_camera, pixels.corners.row(k));
        const Eigen::Vector3d place = quad.at(pixels.weights.row(k)), normal = quad.normal();
        const double cosine = -normal.dot(place) / (normal.norm() * place.norm() + 1e-30);
        const Eigen::Vector2d pixel = camera.project(place);
        if (cosine > facing && pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= image.cols - 1 &&
            pixel.y() <= image.rows - 1) {
            seen.colours.row(k) = rounded(colour_at(image, pixel));
            seen.is_seen[static_cast<std::size_t>(k)] = true;
        }
    }
    return seen;
}

double mirror_correlation(const ColorView& picture, const std::vector<bool>& is_seen) {
    constexpr int kReach = 12;  // the surroundings that brightness is judged by: the width over this
    constexpr double kLeastContrast = 2.0;  // grey levels
    const int size = picture.rows;
    if (picture.cols != size ||
        is_seen.size() != static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {
        throw InvalidInput("a canonical picture is square, and says of every pixel whether it was seen");
    }
    const int reach = size / kReach;
    const auto is_seen_at = [&](int y, int x) { return is_seen[static_cast<std::size_t>(y * size + x)]; };
    cv::Mat1d weight(size, size), grey(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const std::uint8_t* pixel = picture.row(y) + 3 * x;
            weight(y, x) = is_seen_at(y, x);
            grey(y, x) = .299 * pixel[0] + .587 * pixel[1] + .114 * pixel[2];
        }
    }
    const cv::Mat1d cover = cv::max(box_mean(weight, reach), 1e-3);
    cv::Mat1d detail = (grey - box_mean(grey.mul(weight), reach) / cover);
    detail = detail.mul(weight);
    cv::Mat1d contrast;
    cv::sqrt(cv::max(box_mean(detail.mul(detail), reach) / cover, 0.), contrast);
    detail = box_mean(detail / (contrast + kLeastContrast), 1);
    double own = 0, mirrored = 0, both = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            if (is_seen_at(y, x) && is_seen_at(y, size - 1 - x)) {
                const double here = detail(y, x), there = detail(y, size - 1 - x);
                own += here * here;
                mirrored += there * there;
                both += here * there;
            }
        }
    }
    return both / std::sqrt(own * mirrored + 1e-12);
}

}  // namespace mimetic
