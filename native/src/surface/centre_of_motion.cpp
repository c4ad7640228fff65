// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/centre_of_motion.hpp>
#include <string>

namespace mimetic {

Eigen::RowVector3d centre_of_motion(PointsIn points, PointsIn displacements) {
    if (points.rows() == 0 || displacements.rows() != points.rows()) {
        throw InvalidInput("a field needs a displacement for each point; it has " +
                           std::to_string(displacements.rows()) + " for " + std::to_string(points.rows()));
    }
    const Eigen::VectorXd weights = displacements.rowwise().squaredNorm();
    const double sum = weights.sum();
    if (!(sum > 0)) {
        return points.colwise().mean();
    }
    return weights.transpose() * points / sum;
}

}  // namespace mimetic
