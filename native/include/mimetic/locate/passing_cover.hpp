// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

struct Occlusion;

/// F: the share of the face, 0 to 1, that is surely hidden in each of a clip's frames by what passes, as a
/// hand does. What most of them have at the same place of the picture, as a microphone on its stand, does
/// not. Throws InvalidInput: a frame at which nobody has looked.
Eigen::VectorXd passing_shares(const std::vector<Occlusion>& frames);

}  // namespace mimetic
