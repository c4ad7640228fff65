// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/contact/contact.hpp>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/types.hpp>
#include <utility>
#include <vector>

namespace mimetic {

/// The two lips as far as they can touch, the mouth's lining behind them included. vertices: N x 3, metres,
/// head frame; surface: of all triangles; margin: K x 3, where skin becomes lining; inner: 2 x 3, the middle
/// of the upper and of the lower lip; size: the head's, the template's being 1.
Slit lip_slit(PointsIn vertices, TrianglesIn triangles, const MuscleSurface& surface, PointsIn margin,
              PointsIn inner, double size);

/// The rims of one eye's lids, without the corners that they share. margin: vertices on the edge of both
/// lids; corners: 2 x 3, the inner and the outer corner of the eye; size: as for lip_slit.
Slit lid_slit(PointsIn vertices, const std::vector<int>& margin, PointsIn corners, double size);

/// The slits' vertices that are kept (C), and the slits by their indices among these; empty slits are left
/// out. kept: N.
std::pair<std::vector<int>, std::vector<Slit>> number_slits(const std::vector<Slit>& slits,
                                                            const std::vector<bool>& kept);

}  // namespace mimetic
