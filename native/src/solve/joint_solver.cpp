// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint_solver.hpp"

#include <limits>

#include "bounded_step.hpp"

namespace mimetic {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector) {
    const double angle = vector.norm();
    return angle < 1e-12 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() + cross_matrix(vector))
                         : Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

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

void FaceState::apply(const Eigen::VectorXd& step) {
    const Eigen::Matrix3d rotation = rotation_of(step.head<3>()) * camera_from_head.linear();
    camera_from_head.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    camera_from_head.translation() += step.segment<3>(3);
    values += step.tail(values.size());
}

Eigen::VectorXd FaceState::difference_from(const FaceState& other) const {
    Eigen::VectorXd step(6 + values.size());
    const Eigen::AngleAxisd turn(camera_from_head.linear() * other.camera_from_head.linear().transpose());
    step.head<3>() = turn.angle() * turn.axis();
    step.segment<3>(3) = camera_from_head.translation() - other.camera_from_head.translation();
    step.tail(values.size()) = values - other.values;
    return step;
}

void skin_jacobian(const Camera& camera, const FaceState& state, const SkinPoint& skin,
                   Eigen::Matrix<float, 2, Eigen::Dynamic>& jacobian, Eigen::Matrix<double, 2, 3>& by_point) {
    const Eigen::Vector3d turned = state.camera_from_head.linear() *
                                   (skin.neutral + skin.modes * state.values.cast<float>()).cast<double>();
    const Eigen::Matrix<double, 2, 3> projection =
        camera.project_jacobian(turned + state.camera_from_head.translation());
    by_point = projection * state.camera_from_head.linear();
    jacobian.resize(2, 6 + skin.modes.cols());
    jacobian.leftCols<3>() = (-projection * cross_matrix(turned)).cast<float>();
    jacobian.middleCols<3>(3) = projection.cast<float>();
    jacobian.rightCols(skin.modes.cols()).noalias() = by_point.cast<float>() * skin.modes;
}

JointSolver::JointSolver(const FaceMotion& motion, std::vector<Eigen::Vector3f> error_nodes)
    : motion_(motion), error_nodes_(std::move(error_nodes)) {}

void JointSolver::linearise(const Camera& camera, const FaceState& state,
                            const std::vector<SampleMeasurement>& measurements, const NoiseModel& noise,
                            double area_per_sample) {
    measurements_ = &measurements;
    noise_ = noise;
    const std::size_t count = measurements.size();
    const Eigen::Index size = 6 + state.values.size();
    jacobians_.resize(static_cast<Eigen::Index>(2 * count), size);
    displacements_.resize(static_cast<Eigen::Index>(2 * count));
    working_whiteners_.resize(count);
    robust_whiteners_.resize(count);
    by_point_.resize(count);
    error_std_.resize(count);
    // Samples share flow windows and model error: that many of them count as one.
    const double shared_flow = 12;
    const double shared_model =
        std::max(1., noise.correlation_length * noise.correlation_length / area_per_sample);
    Eigen::Matrix<float, 2, Eigen::Dynamic> jacobian;
    Eigen::Matrix<double, 2, 3> by_point;
    for (std::size_t k = 0; k < count; ++k) {
        const SampleMeasurement& measurement = measurements[k];
        skin_jacobian(camera, state, measurement.sample->skin, jacobian, by_point);
        const auto row = static_cast<Eigen::Index>(2 * k);
        jacobians_.middleRows<2>(row) = jacobian;
        displacements_.segment<2>(row) = measurement.displacement.cast<float>();
        by_point_[k] = by_point.cast<float>();
        const double error = std::hypot(noise.model_error, noise.shape_error * measurement.view_angle_sine);
        error_std_[k] = error;
        const double error_px = error * std::sqrt(.5) * by_point.norm();
        const Eigen::Matrix2d model = error_px * error_px * Eigen::Matrix2d::Identity();
        working_whiteners_[k] = whitener_of(shared_flow * measurement.covariance + shared_model * model);
        robust_whiteners_[k] = whitener_of(measurement.covariance + model);
    }
}

void JointSolver::reweight(const Eigen::VectorXd& step) {
    const std::size_t count = measurements_->size();
    robust_weights_.resize(count);
    distances_px_.resize(count);
    rows_.resize(jacobians_.cols(), jacobians_.rows());
    targets_.resize(jacobians_.rows());
    const Eigen::VectorXf residuals = displacements_ - jacobians_ * step.cast<float>();
    for (std::size_t k = 0; k < count; ++k) {
        const SampleMeasurement& measurement = (*measurements_)[k];
        const auto row = static_cast<Eigen::Index>(2 * k);
        const Eigen::Vector2f residual = residuals.segment<2>(row);
        distances_px_[k] = residual.norm();
        const double distance = (robust_whiteners_[k] * residual).norm() / noise_.robust_cut;
        const double kept = distance < 1 ? 1 - distance * distance : 0;
        robust_weights_[k] = static_cast<float>(kept * kept);
        const float weight = robust_weights_[k] * measurement.weight * gate(measurement.correlation);
        const Eigen::Matrix2f whitener = std::sqrt(weight) * working_whiteners_[k];
        rows_.middleCols<2>(row).noalias() = jacobians_.middleRows<2>(row).transpose() * whitener.transpose();
        targets_.segment<2>(row) = whitener * displacements_.segment<2>(row);
    }
    sum_.setZero(jacobians_.cols(), jacobians_.cols());
    sum_.selfadjointView<Eigen::Lower>().rankUpdate(rows_);
    information_ = sum_.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
    pull_ = (rows_ * targets_).cast<double>();
}

Eigen::VectorXd JointSolver::step(const StepPrior& prior, const FaceState& state,
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

Eigen::MatrixXd JointSolver::model_covariance(const Eigen::MatrixXd& working) const {
    // The error field is a sum of bumps at the nodes; each pushes the estimate by its own pull.
    const Eigen::Index size = pull_.size();
    Eigen::MatrixXf pulls = Eigen::MatrixXf::Zero(size, static_cast<Eigen::Index>(3 * error_nodes_.size()));
    const auto radius = static_cast<float>(noise_.correlation_length);
    std::vector<std::pair<Eigen::Index, float>> near;
    for (std::size_t k = 0; k < measurements_->size(); ++k) {
        const auto columns = rows_.middleCols<2>(static_cast<Eigen::Index>(2 * k));
        if (robust_weights_[k] <= 0) {
            continue;
        }
        near.clear();
        float energy = 0;
        const Eigen::Vector3f& point = (*measurements_)[k].sample->skin.neutral;
        for (std::size_t node = 0; node < error_nodes_.size(); ++node) {
            const float distance = (error_nodes_[node] - point).squaredNorm() / (2 * radius * radius);
            if (distance < 3) {
                near.emplace_back(static_cast<Eigen::Index>(3 * node), std::exp(-distance));
                energy += near.back().second * near.back().second;
            }
        }
        const float weight = std::sqrt(robust_weights_[k] * (*measurements_)[k].weight *
                                       gate((*measurements_)[k].correlation));
        const Eigen::Matrix<float, Eigen::Dynamic, 3> moved =
            columns * (weight * working_whiteners_[k] * by_point_[k]);
        const float scale = static_cast<float>(error_std_[k]) / std::sqrt(energy + 1e-9f);
        for (const auto& [column, height] : near) {
            pulls.middleCols<3>(column) += scale * height * moved;
        }
    }
    const Eigen::MatrixXd shifts = working * pulls.cast<double>();
    return shifts * shifts.transpose();
}

}  // namespace mimetic
