// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// How a control answers what is fitted.
struct Response {
    double gain = 1;
    double offset = 0;
    double lowest = 0;  ///< values are cut at both
    double highest = 1;
    /// The power to which a value's share of its end of the range is raised before all else, .1 to 10: above
    /// 1 small motions become smaller, below 1 larger, and the ends stay.
    double curve = 1;
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// Fitted values (N) as they are played. Towards an end of the range that is 0 no curve is applied. Throws
/// InvalidInput.
Eigen::VectorXd played_values(VectorIn fitted, const Response& response);

}  // namespace mimetic
