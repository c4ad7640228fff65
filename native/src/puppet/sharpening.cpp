// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/puppet/sharpening.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

constexpr double kMemory = 20;  // seconds that the mean remembers
constexpr double kDoubt = 1;    // seconds for which a live value's own variance counts in that mean

void check(const ValuesWithStd& one, Eigen::Index size) {
    require(one.values.size() == size && one.std.size() == size,
            "values and their deviations must be as many as the sharpening was made for");
    require(one.values.allFinite() && one.std.allFinite() && (one.std.array() > 0).all(),
            "values must be finite, and deviations finite and above 0");
}

}  // namespace

Sharpening::Sharpening(Eigen::Index size) : excess_(Eigen::VectorXd::Zero(std::max<Eigen::Index>(size, 0))) {
    require(size > 0, "there is nothing to sharpen");
}

void Sharpening::restart() {
    excess_.setZero();
    known_ = 0;
}

ValuesWithStd Sharpening::advance(const ValuesWithStd& live, const ValuesWithStd& taught, double seconds) {
    check(live, excess_.size());
    check(taught, excess_.size());
    require(std::isfinite(seconds) && seconds >= 0, "the time since the picture before must be 0 or more");
    const Eigen::ArrayXd difference = taught.values - live.values;
    const Eigen::ArrayXd own = live.std.array().square(), of_taught = taught.std.array().square();
    const double step = std::min(seconds, 1.);
    const double before = known_ * std::exp(-seconds / kMemory);
    known_ = before + step;
    if (known_ > 0) {
        excess_ = ((before * excess_.array() + step * (difference.square() - of_taught)) / known_).matrix();
    }
    const Eigen::ArrayXd of_live = ((known_ * excess_.array() + kDoubt * own) / (known_ + kDoubt)).max(own);
    const Eigen::ArrayXd share = of_live / (of_live + of_taught);
    return {live.values + (share * difference).matrix(), (share * of_taught).sqrt().matrix()};
}

}  // namespace mimetic
