// SPDX-License-Identifier: GPL-3.0-or-later
#include "joined_eye.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/locate/feature_noise.hpp>
#include <span>

namespace mimetic::locate {
namespace {

/// Error of the regressor's lids on real faces marked by hand, once the person's bias is known, in sides of
/// the crop, where it expects usual ones (docs/measured/real-faces.md). Its irises and corners are not
/// joined: in real faces irises stand up to 4 % of the interpupillary distance too high, outer corners 3 %
/// too far out.
constexpr double kLid = 0.0085, kUsual = 0.0065, kUsualIris = 0.012;

double doubt_of(double worse) { return std::max(1., worse * worse); }

/// The regressor's share in a margin.
double share_of(NetworkFeature lid, double side, double spread) {
    const double network = feature_noise(lid, side).error.y();
    const double own = kLid * lid_doubt(spread);
    return network * network / (network * network + own * own);
}

/// Where a line, by its chord from the first to the last point, is as far along as `along`.
Eigen::RowVector2d point_at(const Points2& line, double along) {
    const Eigen::RowVector2d chord = line.row(line.rows() - 1) - line.row(0);
    const double squared = chord.squaredNorm();
    const auto share = [&](Eigen::Index i) {
        return squared > 0 ? (line.row(i) - line.row(0)).dot(chord) / squared : 0.;
    };
    for (Eigen::Index i = 0; i + 1 < line.rows(); ++i) {
        const double before = share(i), after = share(i + 1);
        if (before <= along && after > along) {
            const double part = (along - before) / (after - before);
            return (1 - part) * line.row(i) + part * line.row(i + 1);
        }
    }
    return along <= 0 ? line.row(0) : line.row(line.rows() - 1);
}

void join_margin(Points2& contour, std::span<const int> margin, const Points2& other, double share) {
    const Eigen::RowVector2d first = contour.row(margin.front()), last = contour.row(margin.back());
    const Eigen::RowVector2d chord = last - first;
    const double squared = chord.squaredNorm();
    for (const int point : margin.subspan(1, margin.size() - 2)) {
        const double along = squared > 0 ? (contour.row(point) - first).dot(chord) / squared : 0.;
        contour.row(point) = (1 - share) * contour.row(point) + share * point_at(other, along);
    }
}

}  // namespace

double lid_doubt(double spread) { return doubt_of(spread / kUsual); }

double iris_doubt(double spread) { return doubt_of(spread / kUsualIris); }

EyePoints joined_eye(const EyePoints& by_network, const RegressedPoints& regressed, double side) {
    constexpr int kMargin = RegressedEye::kMargin;
    EyePoints joined = by_network;
    const Points2 upper = regressed.shares.topRows(kMargin);
    const Points2 lower = regressed.shares.middleRows(kMargin, kMargin);
    join_margin(joined.contour, LidMargins::kUpper, upper,
                share_of(NetworkFeature::upper_lid, side, regressed.spread[0]));
    join_margin(joined.contour, LidMargins::kLower, lower,
                share_of(NetworkFeature::lower_lid, side, regressed.spread[1]));
    return joined;
}

}  // namespace mimetic::locate
