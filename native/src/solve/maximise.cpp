// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <mimetic/solve/evidence.hpp>
#include <opencv2/core/utility.hpp>

namespace mimetic {

namespace {

constexpr double kStep = 1e-2;  // of the coordinates, for differences
constexpr int kMostSteps = 8;
constexpr double kSettled = 1e-3;

struct Derivatives {
    Eigen::VectorXd gradient;
    Eigen::MatrixXd curvature;
};

/// By central differences.
Derivatives derivatives(const Height& height, const Eigen::VectorXd& place, double at_place) {
    const auto size = static_cast<int>(place.size());
    Eigen::VectorXd above(size), below(size);
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(size, size);
    const auto moved = [&](int i, double step) {
        Eigen::VectorXd to = place;
        to[i] += step;
        return to;
    };
    cv::parallel_for_({0, size}, [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) {
            above[i] = height(moved(i, kStep));
            below[i] = height(moved(i, -kStep));
        }
    });
    // Row after row is longer: pairs are counted through so that threads have as much to do
    cv::parallel_for_({0, size * (size - 1) / 2}, [&](const cv::Range& range) {
        int pair = 0;
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < i; ++j, ++pair) {
                if (pair >= range.start && pair < range.end) {
                    Eigen::VectorXd to = moved(i, kStep);
                    to[j] += kStep;
                    both(i, j) = height(to);
                }
            }
        }
    });
    Derivatives found{(above - below) / (2 * kStep), Eigen::MatrixXd(size, size)};
    for (int i = 0; i < size; ++i) {
        found.curvature(i, i) = (above[i] - 2 * at_place + below[i]) / (kStep * kStep);
        for (int j = 0; j < i; ++j) {
            found.curvature(i, j) = found.curvature(j, i) =
                (both(i, j) - above[i] - above[j] + at_place) / (kStep * kStep);
        }
    }
    return found;
}

}  // namespace

Peak maximise(const Height& height, VectorIn start, double bound, const Progress& progress) {
    Peak peak{start, Eigen::VectorXd::Zero(start.size()), height(start)};
    double damping = 1e-3;
    for (int step = 0; step < kMostSteps; ++step) {
        if (progress && !progress(static_cast<double>(step) / (kMostSteps + 1))) {
            return peak;
        }
        const auto [gradient, curvature] = derivatives(height, peak.place, peak.height);
        // Eigenvalues of the wrong sign change sign: a step must lead upwards.
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(-curvature);
        const Eigen::VectorXd along = eigen.eigenvectors().transpose() * gradient;
        double moved = 0;
        while (damping < 1e6 && moved == 0) {
            const Eigen::ArrayXd size = eigen.eigenvalues().array().abs().max(1e-6) + damping;
            const Eigen::VectorXd wanted =
                (peak.place + eigen.eigenvectors() * (along.array() / size).matrix())
                    .cwiseMax((start.array() - bound).matrix())
                    .cwiseMin((start.array() + bound).matrix());
            const double reached = height(wanted);
            if (reached > peak.height) {
                moved = (wanted - peak.place).cwiseAbs().maxCoeff();
                peak.place = wanted;
                peak.height = reached;
                damping /= 4;
            } else {
                damping = 4 * damping + 1e-3;
            }
        }
        if (moved < kSettled) {
            break;
        }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        -derivatives(height, peak.place, peak.height).curvature);
    peak.std =
        (eigen.eigenvectors().cwiseAbs2() * eigen.eigenvalues().cwiseMax(1e-6).cwiseInverse()).cwiseSqrt();
    return peak;
}

}  // namespace mimetic
