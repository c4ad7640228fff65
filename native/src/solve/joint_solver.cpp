// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint_solver.hpp"

#include <Eigen/LU>
#include <limits>

#include "bounded_step.hpp"
#include "in_parts.hpp"

#include "shared/robust.hpp"

namespace mimetic {

namespace {

/// W with W^T W = inverse of the covariance.
Eigen::Matrix2f whitener_of(const Eigen::Matrix2d& covariance) {
    return covariance.inverse().llt().matrixU().toDenseMatrix().cast<float>();
}

float gate(float correlation) {
    constexpr float kLost = .35f, kSure = .7f;
    const float share = std::clamp((correlation - kLost) / (kSure - kLost), 0.f, 1.f);
    return share * share * (3 - 2 * share);
}

}  // namespace

JointSolver::JointSolver(const FaceMotion& motion, ErrorField<float> field)
    : motion_(motion),
      error_field_(std::move(field)),
      field_(Eigen::VectorXf::Zero(static_cast<Eigen::Index>(2 * error_field_.num_nodes()))) {}

void JointSolver::find_near_nodes() {
    near_.clear();
    for (const SampleMeasurement& measurement : *measurements_) {
        const auto [entry, is_new] = near_of_.try_emplace(measurement.sample);
        if (is_new) {
            entry->second = error_field_.near(measurement.sample->skin.neutral);
        }
        near_.push_back(&entry->second);
    }
}

void JointSolver::linearise(const Camera& camera, const FaceState& state,
                            const std::vector<SampleMeasurement>& measurements, const NoiseModel& noise) {
    measurements_ = &measurements;
    noise_ = noise;
    const std::size_t count = measurements.size();
    const Eigen::Index size = 6 + state.values.size();
    evidence_ = {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    reading_errors_.clear();
    jacobians_.resize(static_cast<Eigen::Index>(2 * count), size);
    displacements_.resize(static_cast<Eigen::Index>(2 * count));
    whiteners_.resize(count);
    field_pixels_.resize(count);
    projections_.resize(count);
    find_near_nodes();
    const Eigen::VectorXf values = state.values.cast<float>();
    in_parts(count, [&](std::size_t, std::size_t begin, std::size_t end) {
        Eigen::Matrix<float, 2, Eigen::Dynamic> jacobian;
        Eigen::Matrix<double, 2, 3> by_point;
        for (std::size_t k = begin; k < end; ++k) {
            const SampleMeasurement& measurement = measurements[k];
            const SkinPoint& skin = measurement.sample->skin;
            const Eigen::Vector3f moved = skin.modes * values;
            skin_jacobian(camera, state.camera_from_head, (skin.neutral + moved).cast<double>(),
                          measurement.sample->seen_modes, jacobian, by_point);
            const auto row = static_cast<Eigen::Index>(2 * k);
            jacobians_.middleRows<2>(row) = jacobian;
            projections_[k] = by_point.cast<float>();
            displacements_.segment<2>(row) =
                measurement.displacement.cast<float>() + projections_[k] * measurement.sample->offset;
            const double error = noise.model.std_of(measurement.view_angle_sine, double(moved.norm()));
            field_pixels_[k] = (error * by_point.leftCols<2>()).cast<float>();
            const double fine_px = noise.fine_error * std::sqrt(.5) * by_point.norm();
            whiteners_[k] =
                whitener_of(measurement.covariance + fine_px * fine_px * Eigen::Matrix2d::Identity());
        }
    });
}

void JointSolver::reweight(const Eigen::VectorXd& step, double robust_cut) {
    const std::size_t count = measurements_->size();
    robust_weights_.resize(count);
    weights_.resize(count);
    distances_px_.resize(count);
    rows_.resize(jacobians_.cols(), jacobians_.rows());
    targets_.resize(jacobians_.rows());
    const Eigen::VectorXf flat = step.cast<float>();
    std::vector<Sums> parts(kParts);
    in_parts(count, [&](std::size_t part, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const SampleMeasurement& measurement = (*measurements_)[k];
            const auto row = static_cast<Eigen::Index>(2 * k);
            Eigen::Vector2f field = Eigen::Vector2f::Zero();
            for (const NearNode& near : *near_[k]) {
                field += near.height * field_.segment<2>(2 * near.node);
            }
            const Eigen::Vector2f left =
                displacements_.segment<2>(row) - jacobians_.middleRows<2>(row) * flat;
            distances_px_[k] = left.norm();
            const double distance = (whiteners_[k] * (left - field_pixels_[k] * field)).norm() / robust_cut;
            robust_weights_[k] = static_cast<float>(tukey_weight(distance));
            weights_[k] = robust_weights_[k] * measurement.weight * gate(measurement.correlation) /
                          static_cast<float>(noise_.samples_a_window);
            const Eigen::Matrix2f whitener = std::sqrt(weights_[k]) * whiteners_[k];
            rows_.middleCols<2>(row).noalias() =
                jacobians_.middleRows<2>(row).transpose().lazyProduct(whitener.transpose());
            targets_.segment<2>(row) = whitener * displacements_.segment<2>(row);
        }
        parts[part] = sums_of(begin, end);
    });
    sum_up(parts);
}

JointSolver::Sums JointSolver::sums_of(std::size_t begin, std::size_t end) const {
    const Eigen::Index size = jacobians_.cols();
    const auto num_field = static_cast<Eigen::Index>(2 * error_field_.num_nodes());
    const auto first_row = static_cast<Eigen::Index>(2 * begin);
    const auto rows = rows_.middleCols(first_row, static_cast<Eigen::Index>(2 * end) - first_row);
    Sums sums{Eigen::MatrixXf::Zero(size, size), Eigen::MatrixXf::Zero(size, num_field),
              rows * targets_.segment(first_row, rows.cols()), Eigen::MatrixXf::Zero(num_field, num_field),
              Eigen::VectorXf::Zero(num_field)};
    sums.information.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    Eigen::Matrix<float, Eigen::Dynamic, 2> moved(size, 2);
    for (std::size_t k = begin; k < end; ++k) {
        if (weights_[k] <= 0) {
            continue;
        }
        const auto row = static_cast<Eigen::Index>(2 * k);
        const Eigen::Matrix2f field_rows = std::sqrt(weights_[k]) * whiteners_[k] * field_pixels_[k];
        moved.noalias() = rows_.middleCols<2>(row).lazyProduct(field_rows);
        const Eigen::Matrix2f own = field_rows.transpose() * field_rows;
        const Eigen::Vector2f target = field_rows.transpose() * targets_.segment<2>(row);
        for (const NearNode& first : *near_[k]) {
            sums.field_coupling.middleCols<2>(2 * first.node) += first.height * moved;
            sums.field_pull.segment<2>(2 * first.node) += first.height * target;
            for (const NearNode& second : *near_[k]) {
                sums.field_information.block<2, 2>(2 * first.node, 2 * second.node) +=
                    first.height * second.height * own;
            }
        }
    }
    return sums;
}

void JointSolver::sum_up(const std::vector<Sums>& parts) {
    Sums all = parts.front();
    for (std::size_t part = 1; part < parts.size(); ++part) {
        all.information += parts[part].information;
        all.field_coupling += parts[part].field_coupling;
        all.pull += parts[part].pull;
        all.field_information += parts[part].field_information;
        all.field_pull += parts[part].field_pull;
    }
    information_ = all.information.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
    pull_ = all.pull.cast<double>();
    field_coupling_ = all.field_coupling.transpose();
    field_pull_ = all.field_pull;
    all.field_information.diagonal().array() += 1;
    field_factor_.compute(all.field_information);
    const Eigen::MatrixXf half = field_factor_.matrixL().solve(field_coupling_);
    Eigen::MatrixXf explained = Eigen::MatrixXf::Zero(half.cols(), half.cols());
    explained.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose());
    information_ -= explained.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
    pull_ -= (field_coupling_.transpose() * field_factor_.solve(field_pull_)).cast<double>();
    information_ += evidence_.information;
    pull_ += evidence_.gradient;
    as_read_ = {information_, pull_};
    for (const ReadingError& error : reading_errors_) {
        allow_for(error);
    }
}

/// Evidence of value + error, the error integrated out.
void JointSolver::allow_for(const ReadingError& error) {
    const Eigen::VectorXd along = information_.col(FaceStep::kPose + error.value);
    pull_ -= error.mean * along;
    const double known = along[FaceStep::kPose + error.value];
    const double share = error.variance / (1 + error.variance * known);
    const double own_pull = pull_[FaceStep::kPose + error.value];
    pull_ -= share * own_pull * along;
    information_ -= share * along * along.transpose();
}

/// What the pictures show of a step: with the most probable errors of reading.
Eigen::VectorXd JointSolver::read_step(const Eigen::VectorXd& step) const {
    Eigen::VectorXd read = step;
    for (const ReadingError& error : reading_errors_) {
        const Eigen::Index at = FaceStep::kPose + error.value;
        const double pull = as_read_.gradient[at] - as_read_.information.row(at).dot(read) -
                            error.mean * as_read_.information(at, at);
        read[at] += error.mean + error.variance * pull / (1 + error.variance * as_read_.information(at, at));
    }
    return read;
}

Eigen::VectorXd JointSolver::solve(const StepPrior& prior, const FaceState& state, Eigen::Index num_free,
                                   int num_rounds) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(jacobians_.cols());
    for (int round = 0; round < num_rounds; ++round) {
        // Before the first step, the residual is motion, not error.
        constexpr double kBeforeStep = 3;
        reweight(round == 0 ? step : read_step(step), noise_.robust_cut * (round == 0 ? kBeforeStep : 1));
        step = bounded(prior, state, num_free);
        field_ = field_factor_.solve(field_pull_ - field_coupling_ * read_step(step).cast<float>());
    }
    return step;
}

Eigen::VectorXd JointSolver::bounded(const StepPrior& prior, const FaceState& state,
                                     Eigen::Index num_free) const {
    const Eigen::Index size = pull_.size();
    Eigen::VectorXd lower = Eigen::VectorXd::Constant(size, -std::numeric_limits<double>::infinity());
    Eigen::VectorXd upper = -lower;
    lower.tail(size - 6) = (motion_.lower - state.values).cwiseMin(0);
    upper.tail(size - 6) = (motion_.upper - state.values).cwiseMax(0);
    lower.tail(size - num_free).setZero();
    upper.tail(size - num_free).setZero();
    return bounded_step(information_ + prior.information, pull_ + prior.gradient, lower, upper);
}

}  // namespace mimetic
