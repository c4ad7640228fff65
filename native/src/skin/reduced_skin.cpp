// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <numbers>
#include <string>

#include "cholesky.hpp"
#include "time_step.hpp"

namespace mimetic {
namespace {

// Directions of the span below this share of the strongest are combinations of the others.
constexpr double kDependent = 1e-10;

}  // namespace

ReducedSkin::ReducedSkin(const Eigen::SparseMatrix<double>& stiffness,
                         const Eigen::SparseMatrix<double>& mass,
                         const Eigen::Ref<const Eigen::MatrixXd>& loads, int num_modes,
                         const DynamicsOptions& options)
    : options_(options) {
    options_.check();
    if (loads.rows() != stiffness.rows() || loads.cols() == 0 || mass.rows() != stiffness.rows()) {
        throw InvalidInput("loads are " + std::to_string(loads.rows()) + " x " +
                           std::to_string(loads.cols()) + " for " + std::to_string(stiffness.rows()) +
                           " unknowns and " + std::to_string(mass.rows()) + " rows of mass");
    }
    check_range("num_modes", num_modes, 0, static_cast<double>(stiffness.rows() - 1));
    Cholesky factor;
    factor.compute(stiffness);
    if (factor.info() != Eigen::Success) {
        throw InvalidInput("the skin can move freely: attach it to bone or hold some of its vertices");
    }
    Eigen::MatrixXd span(loads.rows(), loads.cols() + num_modes);
    span.leftCols(loads.cols()) = factor.solve(Eigen::MatrixXd(loads));
    if (num_modes > 0) {
        span.rightCols(num_modes) = vibration_modes(stiffness, mass, num_modes).shapes;
    }
    // Columns of one energy each, so that strong and weak muscles count alike
    const Eigen::MatrixXd force = stiffness * span;
    const Eigen::VectorXd energy = (span.array() * force.array()).colwise().sum().sqrt();
    if (!(energy.minCoeff() > 0)) {
        throw InvalidInput("a load case does nothing: its column of loads is zero or not finite");
    }
    const Eigen::VectorXd scale = energy.cwiseInverse();
    const Eigen::MatrixXd gram = scale.asDiagonal() * (span.transpose() * force) * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> metric(gram);
    const Eigen::VectorXd& weights = metric.eigenvalues();
    const Eigen::Index kept = (weights.array() > kDependent * weights[weights.size() - 1]).count();
    const Eigen::MatrixXd independent = scale.asDiagonal() * metric.eigenvectors().rightCols(kept) *
                                        weights.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
    // In this basis the stiffness is the identity; the mass's eigenvectors decouple the coordinates.
    const Eigen::MatrixXd basis = span * independent;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> inertia(basis.transpose() * (mass * basis));
    if (!(inertia.eigenvalues()[0] > 0)) {
        throw InvalidInput("the mass is not positive definite");
    }
    const Eigen::VectorXd unit_mass = inertia.eigenvalues().cwiseSqrt().cwiseInverse();
    shapes_ = basis * inertia.eigenvectors() * unit_mass.asDiagonal();
    load_ = shapes_.transpose() * loads;
    frequencies_ = unit_mass / (2 * std::numbers::pi);
    stiffness_ = unit_mass.array().square();
    const TimeStep step(options_);
    compliance_ = (step.mass + step.stiffness * stiffness_).inverse();
    reset();
}

void ReducedSkin::reset() {
    displacement_.setZero(num_coordinates());
    velocity_.setZero(num_coordinates());
    acceleration_.setZero(num_coordinates());
    overstrain_.setZero(num_coordinates());
    increment_.setZero(num_coordinates());
}

const Eigen::VectorXd& ReducedSkin::advance(VectorIn values) {
    if (values.size() != num_values()) {
        throw InvalidInput("got " + std::to_string(values.size()) + " values for " +
                           std::to_string(num_values()) + " load cases");
    }
    const TimeStep step(options_);
    increment_.matrix().noalias() = load_ * values;
    increment_ +=
        step.mass_velocity * velocity_ + step.mass_acceleration * acceleration_ +
        stiffness_ * (step.stiffness_velocity * velocity_ - displacement_.array() - step.decay * overstrain_);
    increment_ *= compliance_;
    acceleration_ = step.acceleration * increment_ + step.from_velocity * velocity_ +
                    step.keep_acceleration * acceleration_;
    velocity_ = step.velocity * increment_ + step.keep_velocity * velocity_;
    overstrain_ = step.decay * overstrain_ + step.build_up * increment_;
    displacement_.array() += increment_;
    return displacement_;
}

ReducedSurface::ReducedSurface(const SparseRows& stencils, const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
    if (3 * stencils.cols() != shapes.rows() || shapes.cols() == 0) {
        throw InvalidInput("stencils of " + std::to_string(stencils.cols()) +
                           " control vertices do not fit shapes of " + std::to_string(shapes.rows()) +
                           " unknowns");
    }
    field_.resize(3 * stencils.rows(), shapes.cols());
    for (Eigen::Index r = 0; r < shapes.cols(); ++r) {
        const Eigen::VectorXd shape = shapes.col(r);
        const Points places = stencils * Eigen::Map<const Points>(shape.data(), stencils.cols(), 3);
        field_.col(r) = Eigen::Map<const Eigen::VectorXd>(places.data(), places.size()).cast<float>();
    }
    displacements_.resize(stencils.rows(), 3);
}

const Rows<float, 3>& ReducedSurface::displacements(VectorIn coordinates) {
    if (coordinates.size() != field_.cols()) {
        throw InvalidInput("got " + std::to_string(coordinates.size()) + " coordinates for " +
                           std::to_string(field_.cols()));
    }
    coordinates_ = coordinates.cast<float>();
    Eigen::Map<Eigen::VectorXf>(displacements_.data(), displacements_.size()).noalias() =
        field_ * coordinates_;
    return displacements_;
}

}  // namespace mimetic
