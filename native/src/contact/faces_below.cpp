// SPDX-License-Identifier: GPL-3.0-or-later
#include "faces_below.hpp"

#include <algorithm>
#include <cmath>

namespace mimetic {
namespace {

constexpr std::size_t kNumBins = 64;
constexpr double kSmallest = 1e-15;  // m^2, twice the area of a triangle that is seen on edge
constexpr double kRim = -1e-9;       // of a weight, so that no place falls between two triangles

double doubled_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace

FacesBelow::FacesBelow(const Points& shape, const std::vector<Corners>& triangles, double sign)
    : bins_(kNumBins) {
    std::vector<Face> faces;
    double end = start_;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Face face{static_cast<int>(t), {}, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            face.corners[k] = {shape(triangles[t][k], 0), shape(triangles[t][k], 2)};
        }
        face.doubled = doubled_area(face.corners[0], face.corners[1], face.corners[2]);
        // y is up, so what is counter-clockwise in (x, z) faces down
        if (sign * face.doubled < -kSmallest) {
            for (const Eigen::Vector2d& corner : face.corners) {
                const bool is_first = faces.empty() && &corner == &face.corners[0];
                start_ = is_first ? corner.x() : std::min(start_, corner.x());
                end = is_first ? corner.x() : std::max(end, corner.x());
            }
            faces.push_back(face);
        }
    }
    per_bin_ = std::max((end - start_) / static_cast<double>(kNumBins), 1e-9);
    for (const Face& face : faces) {
        const auto [first, last] =
            std::minmax({face.corners[0].x(), face.corners[1].x(), face.corners[2].x()});
        for (std::size_t bin = bin_of(first); bin <= bin_of(last); ++bin) {
            bins_[bin].push_back(face);
        }
    }
}

std::size_t FacesBelow::bin_of(double x) const {
    const double bin = std::floor((x - start_) / per_bin_);
    return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kNumBins - 1)));
}

FacesBelow::Hit FacesBelow::at(double x, double z) const {
    const Eigen::Vector2d place(x, z);
    for (const Face& face : bins_[bin_of(x)]) {
        const auto& [a, b, c] = face.corners;
        const std::array<double, 3> weights{doubled_area(place, b, c) / face.doubled,
                                            doubled_area(a, place, c) / face.doubled,
                                            doubled_area(a, b, place) / face.doubled};
        if (std::min({weights[0], weights[1], weights[2]}) >= kRim) {
            return {face.number, weights};
        }
    }
    return {};
}

}  // namespace mimetic
