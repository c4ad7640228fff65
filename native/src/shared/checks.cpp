// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <sstream>

namespace mimetic {

void require(bool holds, const std::string& text) {
    if (!holds) {
        throw InvalidInput(text);
    }
}

void check_range(std::string_view name, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
        std::ostringstream text;
        text << name << " is " << value << "; it must be " << low << " to " << high;
        throw InvalidInput(text.str());
    }
}

void check_range_at(std::string_view name, long vertex, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
        check_range(std::string(name) + " at vertex " + std::to_string(vertex), value, low, high);
    }
}

}  // namespace mimetic
