// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/head/head.hpp>

namespace mimetic {

/// A head's model as quads to draw: meridians and parallels of an ellipsoid, rings of a planar patch.
struct ModelMesh {
    Points vertices;  ///< V x 3, metres, head frame
    Quads faces;
};

/// lowest, highest: between which y of the head frame an ellipsoid is wanted, metres. Throws InvalidInput for
/// the model that is a surface: it has vertices of its own.
ModelMesh mesh_of_model(const HeadShape& shape, double lowest, double highest);

}  // namespace mimetic
