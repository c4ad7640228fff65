// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "fit/outline.hpp"

namespace mimetic::fit {

/// A place on a measured line: its direction across, unit, pixels.
struct Station {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();
};

/// The point of a line of the model that a station is matched to: anywhere between its points, so that it
/// varies smoothly. pixels: P x 2, where the model's points are. None within reach, pixels.
std::optional<EdgePoint> partner_on_line(const std::vector<int>& chain, const Points2& pixels,
                                         const Station& station, double reach);

/// The same among single points; those alone that face as the station does.
std::optional<EdgePoint> partner_among(const std::vector<EdgePoint>& candidates, const Station& station,
                                       double reach);

}  // namespace mimetic::fit
