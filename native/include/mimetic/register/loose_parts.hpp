// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/register/foreign_skin.hpp>
#include <mimetic/surface/ways.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// The part of the template that a vertex belongs to, by which loose parts are classified.
enum class TemplatePart { other, lower_jaw, upper_teeth, left_eye, right_eye };

/// Parts of a foreign head besides its skin: teeth, eyes, lashes, hair. A loose part is classified by what
/// most of it is nearest to on the template registered to the head: lower teeth and tongue move with the jaw,
/// upper teeth and eyes stay, what is close to the skin follows it.
struct LooseParts {
    std::vector<bool> on_jaw;                    ///< V, which are fixed to the lower jaw
    std::array<std::vector<bool>, 2> on_eye;     ///< V, which belong to the left and to the right eyeball
    std::array<std::optional<Sphere>, 2> balls;  ///< of left and right eyeball, where one is modelled in full
    std::vector<int> following;                  ///< vertices that move with the skin
    Eigen::VectorXi roots;                       ///< the skin's vertex of each
    int num_left = 0;  ///< vertices near to the skin that are too many to follow it: they stay
};

/// laid: vertices of the template registered to the head, metres; parts: of each.
LooseParts sort_loose_parts(const ForeignSkin& skin, PointsIn laid, const std::vector<TemplatePart>& parts);

/// First guess of the landmarks on a head that faces -y with z up (V x 3, metres): those of a usual head
/// (skin: S x 3, places: L x 3, the tip of the nose in row `nose`) moved and scaled to the top and the front
/// of this one, each at the nearest vertex. L x 3. Throws InvalidInput without vertices.
Points guess_places(PointsIn points, PointsIn usual_skin, PointsIn usual_places, int nose);

}  // namespace mimetic
