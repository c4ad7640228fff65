// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/puppet/match.hpp>

#include "correlate.hpp"

namespace mimetic::puppet {

/// A template at one scale and rotation: as it is matched, and at half of that size to search with.
struct Variant {
    double scale = 1, rotation = 0;
    Kernel fine, coarse;
};

/// A template ready to be matched.
struct PreparedTemplate {
    int level = 0;  ///< times the image is halved
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    Eigen::Vector2d trim = Eigen::Vector2d::Zero();  ///< of `place` from the centre of what is matched
    int group = 0;
    std::vector<Variant> variants;
};

/// The picture halved until it has at most options.most_pixels, at all scales and rotations.
PreparedTemplate prepare(const LookTemplate& look, const MatchOptions& options);

}  // namespace mimetic::puppet
