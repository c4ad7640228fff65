// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Throws InvalidInput unless every face has four different vertices in [0, num_vertices).
void check_faces(QuadsIn faces, int num_vertices);

}  // namespace mimetic
