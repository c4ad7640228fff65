// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Points that are one, in the order of their coordinates.
struct Welded {
    std::vector<int> kept;    // the first of the caller's vertices at each place
    std::vector<int> number;  // V, of the place
};

Welded weld(const Points& points);

/// The connected part of each vertex, by the smallest vertex in it.
std::vector<int> parts_of(const Triangles& triangles, std::size_t num_vertices);

}  // namespace mimetic
