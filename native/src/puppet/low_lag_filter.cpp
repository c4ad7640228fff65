// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/puppet/low_lag_filter.hpp>
#include <mimetic/shared/checks.hpp>
#include <numbers>

namespace mimetic {

void FilterOptions::check() const {
    check_range("lag", lag, 0, 1);
    check_range("quickening", quickening, 0, 100);
    check_range("speed_lag", speed_lag, 0, 1);
}

LowLagFilter::LowLagFilter(VectorIn units, const FilterOptions& options) : units_(units), options_(options) {
    options.check();
    require(units.size() >= 1 && units.allFinite() && units.minCoeff() > 0, "units must be above 0");
    restart();
}

void LowLagFilter::set_options(const FilterOptions& options) {
    options.check();
    options_ = options;
}

void LowLagFilter::restart() {
    has_values_ = false;
    lags_ = Eigen::VectorXd::Constant(units_.size(), options_.lag);
}

Eigen::VectorXd LowLagFilter::advance(VectorIn values, double seconds) {
    require(values.size() == units_.size(), "there must be as many values as units");
    check_range("seconds", seconds, 1e-6, 1e6);
    if (!has_values_) {
        has_values_ = true;
        values_ = raw_ = values;
        speeds_ = Eigen::VectorXd::Zero(values.size());
        return values_;
    }
    const Eigen::VectorXd speeds = (values - raw_).cwiseQuotient(units_) / seconds;
    // dt / (dt + lag): what rises steadily is followed exactly `lag` behind
    speeds_ += seconds / (seconds + options_.speed_lag) * (speeds - speeds_);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        const double added = 2 * std::numbers::pi * options_.quickening * std::abs(speeds_[i]);
        lags_[i] = options_.lag / (1 + options_.lag * added);
        values_[i] += seconds / (seconds + lags_[i]) * (values[i] - values_[i]);
    }
    raw_ = values;
    return values_;
}

}  // namespace mimetic
