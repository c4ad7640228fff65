// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/partner.hpp"

#include <algorithm>

namespace mimetic::fit {
namespace {

// Along the curve a partner must be near; across it may be far at first
constexpr double kAcross = 0.3, kBeside = 9;
constexpr double kAlike = 0.4;  // least cosine between the normals of a match

/// The square of the distance from a station, weighed.
struct Cost {
    explicit Cost(const Station& from) : station(from), tangent(-from.normal.y(), from.normal.x()) {}

    double product(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
        return kAcross * a.dot(station.normal) * b.dot(station.normal) +
               kBeside * a.dot(tangent) * b.dot(tangent);
    }
    double at(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector2d off = pixel - station.place;
        return product(off, off);
    }

    const Station& station;
    Eigen::Vector2d tangent;
};

}  // namespace

std::optional<EdgePoint> partner_on_line(const std::vector<int>& chain, const Points2& pixels,
                                         const Station& station, double reach) {
    std::optional<EdgePoint> best;
    double best_cost = reach * reach;
    const Cost cost(station);
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const Eigen::Vector2d start = pixels.row(chain[i]),
                              way = pixels.row(chain[i + 1]).transpose() - start;
        const double length = cost.product(way, way);
        const double fraction =
            length > 0 ? std::clamp(-cost.product(start - station.place, way) / length, 0.0, 1.0) : 0.0;
        const Eigen::Vector2d pixel = start + fraction * way;
        if (const double here = cost.at(pixel); here < best_cost) {
            best_cost = here;
            best = {chain[i], chain[i + 1], fraction, pixel, {}};
        }
    }
    return best;
}

std::optional<EdgePoint> partner_among(const std::vector<EdgePoint>& candidates, const Station& station,
                                       double reach) {
    std::optional<EdgePoint> best;
    double best_cost = reach * reach;
    const Cost cost(station);
    for (const auto& candidate : candidates) {
        if (candidate.normal.dot(station.normal) < kAlike) continue;
        if (const double here = cost.at(candidate.pixel); here < best_cost) {
            best_cost = here;
            best = candidate;
        }
    }
    return best;
}

}  // namespace mimetic::fit
