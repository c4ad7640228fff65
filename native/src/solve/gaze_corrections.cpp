// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/corrections.hpp>
#include <mimetic/solve/gaze.hpp>

#include "gaze_state.hpp"

namespace mimetic {
namespace {

/// Covariance of the bias of the eyes' four angles in one frame.
Eigen::Matrix4d spread_of_bias() {
    const Eigen::Matrix4d eyes = eyes_by_state();
    return eyes * kUnseen.cwiseAbs2().asDiagonal() * eyes.transpose();
}

void check(const MatrixRows& angles, const std::vector<GazePin>& pins) {
    if (angles.cols() != 4 || !angles.allFinite()) {
        throw InvalidInput("gaze is four finite angles a frame");
    }
    for (const GazePin& pin : pins) {
        if (pin.index < 0 || pin.index >= angles.rows() || pin.angle < 0 || pin.angle >= 4) {
            throw InvalidInput("a correction of the gaze is of frame " + std::to_string(pin.index) +
                               ", angle " + std::to_string(pin.angle) + ", there are " +
                               std::to_string(angles.rows()) + " and 4");
        }
        if (!std::isfinite(pin.value) || !(pin.std > 1e-9 && pin.std < 1e9) ||
            !(pin.reach >= 1 && pin.reach < 1e6)) {
            throw InvalidInput(
                "a correction of the gaze needs a finite value, a standard deviation, a reach");
        }
    }
}

}  // namespace

MatrixRows corrected_gaze(const MatrixRows& angles, const std::vector<GazePin>& pins) {
    check(angles, pins);
    const Eigen::Matrix4d spread = spread_of_bias();
    const auto count = static_cast<Eigen::Index>(pins.size());
    const auto pin = [&](Eigen::Index k) -> const GazePin& { return pins[static_cast<std::size_t>(k)]; };
    Eigen::MatrixXd total(count, count);
    Eigen::VectorXd missing(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        missing[k] = pin(k).value - angles(pin(k).index, pin(k).angle);
        for (Eigen::Index other = 0; other < count; ++other) {
            total(k, other) = bias_correlation(pin(k).index - pin(other).index, pin(other).reach) *
                              spread(pin(k).angle, pin(other).angle);
        }
        total(k, k) += pin(k).std * pin(k).std;
    }
    const Eigen::VectorXd weights = total.partialPivLu().solve(missing);
    MatrixRows corrected = angles;
    for (Eigen::Index t = 0; t < angles.rows(); ++t) {
        Eigen::Vector4d bias = Eigen::Vector4d::Zero();
        for (Eigen::Index k = 0; k < count; ++k) {
            const double share = bias_correlation(static_cast<double>(t) - pin(k).index, pin(k).reach);
            bias += share * weights[k] * spread.col(pin(k).angle);
        }
        if (bias.isZero(0)) {
            continue;  // to the bit as it was
        }
        for (int eye = 0; eye < 2; ++eye) {
            const EyeAngles turn = within_eyes_range(
                {angles(t, 2 * eye) + bias[2 * eye], angles(t, 2 * eye + 1) + bias[2 * eye + 1]});
            corrected(t, 2 * eye) = turn.yaw;
            corrected(t, 2 * eye + 1) = turn.pitch;
        }
    }
    return corrected;
}

}  // namespace mimetic
