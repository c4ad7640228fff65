// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Values of one moment with their standard deviations.
struct ValuesWithStd {
    Eigen::VectorXd values;
    Eigen::VectorXd std;
};

/// Live values corrected by what a taught set says of the same picture, each by its variance.
///
/// What a taught set says counts as a measurement z whose variance R is known by leaving examples out; a live
/// value x is off by its bias as well, which its own variance does not know. So its variance P is measured
/// while it runs [Mehra 1970]: if the errors of both are independent, (z - x)^2 is P + R in the mean. The
/// corrected value is x + P / (P + R) (z - x).
class Sharpening {
public:
    explicit Sharpening(Eigen::Index size);  ///< throws InvalidInput unless size is above 0

    /// live, taught: of equal size, all finite, deviations above 0; seconds: since the moment before, at
    /// least 0. Throws InvalidInput.
    ValuesWithStd advance(const ValuesWithStd& live, const ValuesWithStd& taught, double seconds);

    void restart();  ///< another face: nothing is known of its live values

private:
    Eigen::VectorXd excess_;  // mean of (z - x)^2 - R
    double known_ = 0;        // seconds that the mean is of
};

}  // namespace mimetic
