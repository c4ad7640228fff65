// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace mimetic {

/// Throws InvalidInput with this text unless the condition holds.
void require(bool holds, const std::string& text);

/// Throws InvalidInput unless a number lies in [low, high]; the text has its name, the number and the limits.
void check_range(std::string_view name, double value, double low, double high);

/// The same for a number of a list, one a vertex.
void check_range_at(std::string_view name, long vertex, double value, double low, double high);

}  // namespace mimetic
