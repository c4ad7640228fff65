// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/register/foreign_skin.hpp>
#include <vector>

namespace mimetic {

/// What a vertex of the template belongs to, as far as what is loose can be recognised by it.
enum class TemplatePart { other, lower_jaw, upper_teeth, left_eye, right_eye };

/// What lies on and in a foreign head besides its skin: teeth, eyes, lashes, hair. A loose part is what most
/// of it lies nearest to on the template laid onto the head: lower teeth and tongue go with the jaw, upper
/// teeth and eyes stay, what lies close to the skin follows it.
struct LooseParts {
    std::vector<bool> on_jaw;                 ///< V, which are fixed to the lower jaw
    std::array<std::vector<bool>, 2> on_eye;  ///< V, which belong to the left and to the right eyeball
    std::vector<int> following;               ///< vertices that go where skin goes
    Eigen::VectorXi roots;                    ///< the skin's vertex of each
    int num_left = 0;  ///< vertices near to the skin that are too many to follow it: they stay
};

/// laid: vertices of the template laid onto the head, metres; parts: of each.
LooseParts sort_loose_parts(const ForeignSkin& skin, PointsIn laid, const std::vector<TemplatePart>& parts);

/// Where the landmarks may be on a head that looks along -y with its top in z (V x 3, metres): those of a
/// usual head (skin: S x 3, places: L x 3, the tip of the nose in row `nose`) moved and scaled to the top and
/// the front of this one, each on the vertex next to it. L x 3. Throws InvalidInput on no vertices.
Points guess_places(PointsIn points, PointsIn usual_skin, PointsIn usual_places, int nose);

}  // namespace mimetic
