// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <sstream>

namespace mimetic {
namespace {

std::string none_of(int vertex, Eigen::Index num_vertices, std::string_view what) {
    return "vertex " + std::to_string(vertex) + ", the " + std::string(what) + " has " +
           std::to_string(num_vertices) + " vertices";
}

}  // namespace

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

void check_corners(
    const Eigen::Ref<const Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>& faces,
    Eigen::Index num_vertices, std::string_view what) {
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (const int vertex : faces.row(f)) {
            if (vertex < 0 || vertex >= num_vertices) {
                throw InvalidInput("face " + std::to_string(f) + " names " +
                                   none_of(vertex, num_vertices, what));
            }
        }
    }
}

void check_vertices(const std::vector<int>& vertices, Eigen::Index num_vertices, std::string_view what) {
    for (const int vertex : vertices) {
        if (vertex < 0 || vertex >= num_vertices) {
            throw InvalidInput(none_of(vertex, num_vertices, what));
        }
    }
}

}  // namespace mimetic
