// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail_solver.hpp"

#include <array>

#include "block_banded.hpp"
#include "in_parts.hpp"

namespace mimetic {

DetailSolver::DetailSolver(const FaceMotion& motion)
    : prior_(motion.detail_std.cwiseAbs2().cwiseInverse().asDiagonal()) {}

DetailEstimate DetailSolver::solve(const JointSolver& solver,
                                   const std::vector<SampleMeasurement>& measurements,
                                   const Eigen::VectorXd& step, const DetailTerms& other) {
    const Eigen::Index size = prior_.rows();
    rows_.resize(size, static_cast<Eigen::Index>(2 * measurements.size()));
    std::array<Sums, kParts> parts;
    in_parts(measurements.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Eigen::Matrix<float, 2, 3> whitened = solver.whitener(k) * solver.projection(k);
            rows_.middleCols<2>(static_cast<Eigen::Index>(2 * k)).noalias() =
                measurements[k].sample->seen_detail_modes.transpose() * whitened.transpose();
        }
        const auto first = static_cast<Eigen::Index>(2 * begin);
        const auto rows = rows_.middleCols(first, static_cast<Eigen::Index>(2 * end) - first);
        parts[part].information.setZero(size, size);
        parts[part].information.selfadjointView<Eigen::Lower>().rankUpdate(rows);
        parts[part].coupling = rows * solver.rows().middleCols(first, rows.cols()).transpose();
        parts[part].pull = rows * solver.targets().segment(first, rows.cols());
    });
    Sums& sums = parts.front();
    for (std::size_t part = 1; part < parts.size(); ++part) {
        sums.information += parts[part].information;
        sums.coupling += parts[part].coupling;
        sums.pull += parts[part].pull;
    }
    const Eigen::MatrixXd information =
        sums.information.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>() + other.information;
    const Eigen::MatrixXd of_samples = sums.coupling.cast<double>();
    const Eigen::MatrixXd coupling = of_samples + other.coupling;
    const Eigen::VectorXd pull = sums.pull.cast<double>() - of_samples * step + other.pull;
    const Eigen::MatrixXd covariance =
        (information + prior_).llt().solve(Eigen::MatrixXd::Identity(size, size));
    return {covariance * pull, covariance.diagonal().cwiseSqrt(), information, coupling, pull};
}

std::vector<DetailEstimate> smooth_detail(const std::vector<FrameEstimate>& estimates,
                                          const std::vector<Eigen::VectorXd>& steps, const FaceMotion& motion,
                                          double std_acceleration) {
    const Eigen::Index size = motion.detail_std.size();
    if (size == 0) {
        return std::vector<DetailEstimate>(estimates.size());
    }
    const Eigen::VectorXd prior = motion.detail_std.cwiseAbs2().cwiseInverse();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(size);
    const std::size_t count = estimates.size();
    BlockBanded matrix{std::vector<Eigen::MatrixXd>(count, Eigen::MatrixXd(prior.asDiagonal())),
                       std::vector<Eigen::VectorXd>(count, none), std::vector<Eigen::VectorXd>(count, none)};
    std::vector<Eigen::VectorXd> coefficients(count, none);
    for (std::size_t t = 0; t < count; ++t) {
        if (!estimates[t].held) {
            const DetailEstimate& detail = estimates[t].detail;
            matrix.diagonal[t] += detail.information;
            coefficients[t] = detail.pull - detail.coupling * steps[t];
        }
    }
    matrix.add_second_differences(prior / (std_acceleration * std_acceleration));
    BlockBandedFactor(matrix).solve(coefficients);
    std::vector<DetailEstimate> smoothed;
    for (std::size_t t = 0; t < count; ++t) {
        smoothed.push_back(estimates[t].detail);
        smoothed[t].coefficients = coefficients[t];
    }
    return smoothed;
}

}  // namespace mimetic
