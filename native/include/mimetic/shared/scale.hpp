// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace mimetic {

/// Between the pupils, metres: the mean of adults. The template is built to it, and fits take their scale
/// from it, as one camera shows none.
inline constexpr double kPupilDistance = .063;

}  // namespace mimetic
