// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <string>

#include "cholesky.hpp"
#include "time_step.hpp"

namespace mimetic {

struct SkinDynamics::Parts {
    Eigen::SparseMatrix<double> stiffness, mass;
    DynamicsOptions options;
    TimeStep step;
    Cholesky factor;
    DynamicState state;
    Eigen::VectorXd mass_side, stiffness_side, increment;

    void check_size(VectorIn vector, const char* name) const {
        if (vector.size() != stiffness.rows()) {
            throw InvalidInput(std::string(name) + " has " + std::to_string(vector.size()) +
                               " values, needed are " + std::to_string(stiffness.rows()));
        }
    }
};

SkinDynamics::SkinDynamics(const Eigen::SparseMatrix<double>& stiffness,
                           const Eigen::SparseMatrix<double>& mass, const DynamicsOptions& options)
    : parts_(new Parts{stiffness, mass, options, TimeStep(options), {}, {}, {}, {}, {}}) {
    const auto size = stiffness.rows();
    if (size == 0 || stiffness.cols() != size || mass.rows() != size || mass.cols() != size) {
        throw InvalidInput("stiffness and mass must be square and of one size, got " + std::to_string(size) +
                           " x " + std::to_string(stiffness.cols()) + " and " + std::to_string(mass.rows()) +
                           " x " + std::to_string(mass.cols()));
    }
    parts_->factor.compute(parts_->step.mass * mass + parts_->step.stiffness * stiffness);
    if (parts_->factor.info() != Eigen::Success) {
        throw InvalidInput("stiffness and mass are not positive definite");
    }
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(size);
    parts_->state = {zero, zero, zero, zero};
}

SkinDynamics::~SkinDynamics() = default;
SkinDynamics::SkinDynamics(SkinDynamics&&) noexcept = default;
SkinDynamics& SkinDynamics::operator=(SkinDynamics&&) noexcept = default;

const DynamicState& SkinDynamics::state() const { return parts_->state; }

void SkinDynamics::start(VectorIn displacement, VectorIn velocity, VectorIn load) {
    parts_->check_size(displacement, "displacement");
    parts_->check_size(velocity, "velocity");
    parts_->check_size(load, "load");
    Cholesky mass_factor;
    mass_factor.compute(parts_->mass);
    if (mass_factor.info() != Eigen::Success) {
        throw InvalidInput("the mass is not positive definite");
    }
    const DynamicsOptions& options = parts_->options;
    const Eigen::VectorXd force =
        load - parts_->stiffness * (displacement + options.stiffness_damping * velocity);
    DynamicState& state = parts_->state;
    state.acceleration = mass_factor.solve(force) - options.mass_damping * velocity;
    state.displacement = displacement;
    state.velocity = velocity;
    state.overstrain.setZero();
}

const DynamicState& SkinDynamics::advance(VectorIn load) {
    parts_->check_size(load, "load");
    const TimeStep& step = parts_->step;
    DynamicState& now = parts_->state;
    parts_->mass_side = step.mass_velocity * now.velocity + step.mass_acceleration * now.acceleration;
    parts_->stiffness_side =
        step.stiffness_velocity * now.velocity - now.displacement - step.decay * now.overstrain;
    Eigen::VectorXd& right = parts_->increment;
    right = load;
    right += parts_->mass * parts_->mass_side;
    right += parts_->stiffness * parts_->stiffness_side;
    right = Eigen::VectorXd(parts_->factor.solve(right));
    now.acceleration = step.acceleration * right + step.from_velocity * now.velocity +
                       step.keep_acceleration * now.acceleration;
    now.velocity = step.velocity * right + step.keep_velocity * now.velocity;
    now.overstrain = step.decay * now.overstrain + step.build_up * right;
    now.displacement += right;
    return now;
}

double SkinDynamics::energy() const {
    const DynamicState& now = parts_->state;
    return (now.velocity.dot(parts_->mass * now.velocity) +
            now.displacement.dot(parts_->stiffness * now.displacement)) /
           2;
}

}  // namespace mimetic
