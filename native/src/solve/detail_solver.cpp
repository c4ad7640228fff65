// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail_solver.hpp"

#include "block_banded.hpp"

namespace mimetic {

DetailSolver::DetailSolver(const FaceMotion& motion)
    : prior_(motion.detail_std.cwiseAbs2().cwiseInverse().asDiagonal()) {}

DetailEstimate DetailSolver::solve(const JointSolver& solver,
                                   const std::vector<SampleMeasurement>& measurements,
                                   const Eigen::VectorXd& step, const DetailTerms& other) {
    const Eigen::Index size = prior_.rows();
    rows_.resize(size, static_cast<Eigen::Index>(2 * measurements.size()));
    for (std::size_t k = 0; k < measurements.size(); ++k) {
        const Eigen::Matrix<float, 2, 3> whitened = solver.whitener(k) * solver.projection(k);
        rows_.middleCols<2>(static_cast<Eigen::Index>(2 * k)).noalias() =
            measurements[k].sample->seen_detail_modes.transpose() * whitened.transpose();
    }
    sum_.setZero(size, size);
    sum_.selfadjointView<Eigen::Lower>().rankUpdate(rows_);
    const Eigen::MatrixXd information =
        sum_.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>() + other.information;
    const Eigen::MatrixXd of_samples = (rows_ * solver.rows().transpose()).cast<double>();
    const Eigen::MatrixXd coupling = of_samples + other.coupling;
    const Eigen::VectorXd pull = (rows_ * solver.targets()).cast<double>() - of_samples * step + other.pull;
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
