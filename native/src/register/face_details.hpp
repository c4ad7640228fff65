// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/register/shown_head.hpp>
#include <optional>

namespace mimetic {

/// The part of a mesh that shows most of 468 points of a face: its skin. The head in the template's frame.
int skin_part(const ShownHead& head, const Points& places);

/// An eye's opening as seen from the front: where no skin faces the viewer. Metres, (x, y).
struct EyeOpening {
    Eigen::Vector2d inner, outer;

    /// Where a place lies in the frame of the opening, in its widths from the inner end: along it, across it.
    Eigen::Vector2d share_of(const Eigen::Vector2d& place) const;
    Eigen::Vector2d place_of(const Eigen::Vector2d& share) const;
};

/// The opening between an eye's corners (roughly known); nothing where the eye is modelled shut or has no
/// edge.
std::optional<EyeOpening> eye_opening(const ShownHead& head, int skin, const Eigen::Vector3d& inner,
                                      const Eigen::Vector3d& outer);

/// A place that stands out towards the viewer.
struct Peak {
    Eigen::Vector3d place;
    double height;  ///< m, over the median of what is shown round it
};

/// The foremost place within 12 mm of a point; nothing if none stands out there.
std::optional<Peak> foremost(const ShownHead& head, const Eigen::Vector3d& near);

/// Where skin facing the viewer lies under (x, y); nothing if there is none.
std::optional<Eigen::Vector3d> skin_at(const ShownHead& head, int skin, const Eigen::Vector2d& place);

/// Each of the points (K x 3) moved to the nearest place of the mesh that the front or one of the sides
/// shows.
Points on_shown_surface(const ShownHead& head, const Points& points);

}  // namespace mimetic
