// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace mimetic {

/// Throws InvalidInput with this text unless the condition holds.
void require(bool holds, const std::string& text);

/// Throws InvalidInput unless a number lies in [low, high]; the text has its name, the number and the limits.
void check_range(std::string_view name, double value, double low, double high);

/// The same for a number of a list, one a vertex.
void check_range_at(std::string_view name, long vertex, double value, double low, double high);

/// Throws InvalidInput, naming the first face with a corner that is no vertex. what: has the vertices.
void check_corners(
    const Eigen::Ref<const Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>& faces,
    Eigen::Index num_vertices, std::string_view what = "mesh");

/// The same of a list of vertices.
void check_vertices(const std::vector<int>& vertices, Eigen::Index num_vertices,
                    std::string_view what = "mesh");

}  // namespace mimetic
