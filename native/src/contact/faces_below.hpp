// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Which of a surface's triangles lies over or under a place, as seen along y.
class FacesBelow {
public:
    using Corners = std::array<int, 3>;

    struct Hit {
        int face = -1;  // none
        std::array<double, 3> weights{};
    };

    /// sign: 1 keeps triangles that face up, -1 those that face down.
    FacesBelow(const Points& shape, const std::vector<Corners>& triangles, double sign);

    Hit at(double x, double z) const;  // the first triangle that holds the place

private:
    struct Face {
        int number = 0;
        std::array<Eigen::Vector2d, 3> corners;  // x, z
        double doubled = 0;                      // area, signed
    };

    std::size_t bin_of(double x) const;

    double start_ = 0;
    double per_bin_ = 1;
    std::vector<std::vector<Face>> bins_;  // by x
};

}  // namespace mimetic
