// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/retarget/response.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {

namespace {

constexpr double kMost = 1e3;  // of gain, offset and bounds

}  // namespace

void Response::check() const {
    check_range("Response.gain", gain, -kMost, kMost);
    check_range("Response.offset", offset, -kMost, kMost);
    check_range("Response.lowest", lowest, -kMost, kMost);
    check_range("Response.highest", highest, lowest, kMost);
    check_range("Response.curve", curve, .1, 10);
}

Eigen::VectorXd played_values(VectorIn fitted, const Response& response) {
    response.check();
    require(fitted.allFinite(), "fitted values must be finite");
    return fitted.unaryExpr([&](double value) {
        const double end = value < 0 ? response.lowest : response.highest;
        // A range that is all on one side of 0 has no end on the other
        const double share = end == 0 ? 0 : value / end;
        const double curved = share > 0 ? end * std::pow(share, response.curve) : value;
        return std::clamp(response.gain * curved + response.offset, response.lowest, response.highest);
    });
}

}  // namespace mimetic
