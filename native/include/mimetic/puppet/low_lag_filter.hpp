// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

struct FilterOptions {
    double lag = 0.05;        ///< s at rest, 0 to 1; 0: nothing is filtered
    double quickening = 1.5;  ///< Hz of cutoff a unit a second, 0 to 100: how much less the lag is in motion
    double speed_lag = 0.02;  ///< s of the speed that decides, 0 to 1
    void check() const;       ///< throws InvalidInput: field, value, limit
};

/// One Euro filter [Casiez, Roussel and Vogel 2012] of several values: still at rest, quick in motion. What
/// rises steadily is followed exactly `lags()` behind.
class LowLagFilter {
public:
    /// units: what 1 is of each value; 1 for an activation, some degrees for an angle. Throws InvalidInput.
    LowLagFilter(VectorIn units, const FilterOptions& options = {});

    /// Values `seconds` after those before, > 0.
    Eigen::VectorXd advance(VectorIn values, double seconds);

    Eigen::Index size() const { return units_.size(); }
    const Eigen::VectorXd& lags() const { return lags_; }  ///< s, of each value in the last step
    void set_options(const FilterOptions& options);        ///< from the next step on; throws InvalidInput
    void restart();                                        ///< the next values are taken as they are

private:
    Eigen::VectorXd units_;
    FilterOptions options_;
    bool has_values_ = false;
    Eigen::VectorXd values_, raw_, speeds_, lags_;
};

}  // namespace mimetic
