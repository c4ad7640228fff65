// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

namespace mimetic {

/// Called at intervals with the fraction done, 0 to 1; false stops the work, which then returns what it has.
using Progress = std::function<bool(double fraction)>;

}  // namespace mimetic
