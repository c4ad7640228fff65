// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <numbers>

namespace mimetic {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

Sparse scalar(double value) { return Eigen::MatrixXd::Constant(1, 1, value).sparseView(1, -1); }
Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Springs between `count` masses and two walls.
Sparse chain(int count, double spring) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < count; ++i) {
        entries.emplace_back(i, i, 2 * spring);
        if (i > 0) {
            entries.emplace_back(i, i - 1, -spring);
            entries.emplace_back(i - 1, i, -spring);
        }
    }
    Sparse result(count, count);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

Sparse unit(int count) {
    Sparse result(count, count);
    result.setIdentity();
    return result;
}

constexpr double kMass = 0.3;
constexpr double kStiffness = 50;

TEST(SkinDynamics, NewmarkTurnsAnOscillatorByItsKnownAngleAStep) {
    DynamicsOptions options;
    options.step = 0.02;
    SkinDynamics oscillator(scalar(kStiffness), scalar(kMass), options);
    oscillator.start(one(1), one(0), one(0));
    const double omega = std::sqrt(kStiffness / kMass);
    const double angle = 2 * std::atan(omega * options.step / 2);
    for (int n = 1; n <= 500; ++n) {
        oscillator.advance(one(0));
        ASSERT_NEAR(oscillator.state().displacement[0], std::cos(n * angle), 1e-10) << "step " << n;
    }
}

/// Error after 0.4 s of a damped oscillator let go at 1, against the closed form.
double damped_error(TimeScheme scheme, int steps) {
    DynamicsOptions options;
    options.scheme = scheme;
    options.step = 0.4 / steps;
    options.mass_damping = 2;
    options.stiffness_damping = 0.01;
    SkinDynamics oscillator(scalar(kStiffness), scalar(kMass), options);
    oscillator.start(one(1), one(0), one(0));
    for (int n = 0; n < steps; ++n) {
        oscillator.advance(one(0));
    }
    const double decay = (2 + 0.01 * kStiffness / kMass) / 2;
    const double omega = std::sqrt(kStiffness / kMass - decay * decay);
    const double exact =
        std::exp(-decay * 0.4) * (std::cos(omega * 0.4) + decay / omega * std::sin(omega * 0.4));
    return std::abs(oscillator.state().displacement[0] - exact);
}

TEST(SkinDynamics, NewmarkConvergesWithTheSquareOfTheStep) {
    const double ratio = damped_error(TimeScheme::newmark, 100) / damped_error(TimeScheme::newmark, 200);
    EXPECT_NEAR(std::log2(ratio), 2, 0.05);
    EXPECT_LT(damped_error(TimeScheme::newmark, 200), 2e-4);
}

TEST(SkinDynamics, BackwardEulerConvergesWithTheStep) {
    const auto scheme = TimeScheme::backward_euler;
    EXPECT_NEAR(std::log2(damped_error(scheme, 1600) / damped_error(scheme, 3200)), 1, 0.05);
}

/// Displacement after `steps` of a relaxing spring without mass under a load that is a function of time.
template <typename Load>
double relaxed_spring(TimeScheme scheme, double step, int steps, Load load) {
    DynamicsOptions options;
    options.scheme = scheme;
    options.step = step;
    options.relaxation_share = 0.4;
    options.relaxation_time = 0.5;
    SkinDynamics spring(scalar(kStiffness), scalar(0), options);
    for (int n = 1; n <= steps; ++n) {
        spring.advance(one(load(n * step)));
    }
    return spring.state().displacement[0];
}

TEST(SkinDynamics, RampOfARelaxingSpringIsExactAtAnyStep) {
    // A ramp of 2 m/s loads the Maxwell element by share * rate * tau (1 - exp(-t / tau)).
    const auto load = [](double t) { return kStiffness * (2 * t + 0.4 * 2 * 0.5 * -std::expm1(-t / 0.5)); };
    for (const auto scheme : {TimeScheme::newmark, TimeScheme::backward_euler}) {
        EXPECT_NEAR(relaxed_spring(scheme, 0.01, 100, load), 2, 1e-12);
        EXPECT_NEAR(relaxed_spring(scheme, 0.5, 2, load), 2, 1e-12);
    }
}

TEST(SkinDynamics, CreepFollowsTheStandardLinearSolid) {
    const auto load = [](double) { return kStiffness; };
    // tau (1 + share) is the time of creep, 1 / (1 + share) the immediate part.
    const auto creep = [](double t) { return 1 - 0.4 / 1.4 * std::exp(-t / (0.5 * 1.4)); };
    const auto error = [&](int steps) {
        return std::abs(relaxed_spring(TimeScheme::newmark, 1.0 / steps, steps, load) - creep(1));
    };
    EXPECT_LT(error(1000), 1e-3);
    EXPECT_NEAR(error(500) / error(1000), 2, 0.1);  // the jump of the load falls within one step
    EXPECT_NEAR(relaxed_spring(TimeScheme::newmark, 0.01, 2000, load), 1, 1e-9);
}

TEST(SkinDynamics, NewmarkKeepsTheEnergyOfWhatIsNotDamped) {
    SkinDynamics masses(chain(30, kStiffness), kMass * unit(30), {});
    masses.start(Eigen::VectorXd::LinSpaced(30, 0, 0.01), Eigen::VectorXd::LinSpaced(30, 0.1, -0.2),
                 Eigen::VectorXd::Zero(30));
    const double before = masses.energy();
    for (int n = 0; n < 2000; ++n) {
        masses.advance(Eigen::VectorXd::Zero(30));
    }
    EXPECT_NEAR(masses.energy(), before, 1e-10 * before);
}

TEST(SkinDynamics, ComesToRestAtTheStaticResponse) {
    DynamicsOptions options;
    options.step = 0.05;
    options.mass_damping = 8;
    options.relaxation_share = 0.4;
    for (const auto scheme : {TimeScheme::newmark, TimeScheme::backward_euler}) {
        options.scheme = scheme;
        SkinDynamics masses(chain(10, kStiffness), kMass * unit(10), options);
        const Eigen::VectorXd load = Eigen::VectorXd::LinSpaced(10, -1, 3);
        for (int n = 0; n < 1000; ++n) {
            masses.advance(load);
        }
        const Eigen::VectorXd force = chain(10, kStiffness) * masses.state().displacement;
        EXPECT_LT((force - load).norm(), 1e-6 * load.norm());
    }
}

TEST(VibrationModes, OfAChainAreKnown) {
    constexpr int kCount = 60;
    const VibrationModes modes = vibration_modes(chain(kCount, kStiffness), kMass * unit(kCount), 12);
    for (int i = 0; i < 12; ++i) {
        const double omega =
            2 * std::sqrt(kStiffness / kMass) * std::sin((i + 1) * std::numbers::pi / 2 / (kCount + 1));
        EXPECT_NEAR(modes.frequencies[i], omega / 2 / std::numbers::pi, 1e-8 * omega) << "mode " << i;
    }
    const Eigen::MatrixXd gram = kMass * modes.shapes.transpose() * modes.shapes;
    EXPECT_LT((gram - Eigen::MatrixXd::Identity(12, 12)).norm(), 1e-8);
}

/// Largest difference of the reduced chain from the full one over half a second, as a share of the motion.
double reduction_error(int num_modes) {
    constexpr int kCount = 40;
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(kCount, 2);
    loads(5, 0) = 1;
    loads(30, 1) = -2;
    DynamicsOptions options;
    options.mass_damping = 3;
    options.stiffness_damping = 0.01;
    options.relaxation_share = 0.4;
    SkinDynamics full(chain(kCount, 5000), 0.01 * unit(kCount), options);
    ReducedSkin reduced(chain(kCount, 5000), 0.01 * unit(kCount), loads, num_modes, options);
    double difference = 0;
    double motion = 0;
    for (int n = 1; n <= 120; ++n) {
        const Eigen::Vector2d values(std::min(1.0, n / 12.0), std::sin(n / 10.0));
        const Eigen::VectorXd u = full.advance(loads * values).displacement;
        difference = std::max(difference, (reduced.shapes() * reduced.advance(values) - u).norm());
        motion = std::max(motion, u.norm());
    }
    return difference / motion;
}

TEST(ReducedSkin, ApproachesTheFullModelWithMoreModes) {
    EXPECT_LT(reduction_error(10), 0.01);
    EXPECT_LT(reduction_error(10), 0.2 * reduction_error(0));
    EXPECT_LT(reduction_error(39), 1e-8);
}

TEST(ReducedSkin, RestsExactlyAtTheStaticResponse) {
    constexpr int kCount = 40;
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(kCount, 3);
    loads(3, 0) = loads(20, 1) = 1;
    loads.col(2) = loads.col(0) + loads.col(1);  // says nothing new
    DynamicsOptions options;
    options.scheme = TimeScheme::backward_euler;
    options.step = 1;
    ReducedSkin reduced(chain(kCount, 50), 0.01 * unit(kCount), loads, 4, options);
    EXPECT_EQ(reduced.num_coordinates(), 6);
    const Eigen::Vector3d values(0.3, -1, 0.5);
    for (int n = 0; n < 200; ++n) {
        reduced.advance(values);
    }
    const Eigen::VectorXd force = chain(kCount, 50) * (reduced.shapes() * reduced.coordinates());
    EXPECT_LT((force - loads * values).norm(), 1e-8);
}

TEST(ReducedSurface, IsTheStencilsOfTheShapes) {
    SparseRows stencils(2, 4);
    stencils.insert(0, 1) = 0.25;
    stencils.insert(0, 2) = 0.75;
    stencils.insert(1, 3) = 1;
    const Eigen::MatrixXd shapes = Eigen::MatrixXd::Random(12, 5);
    const Eigen::VectorXd coordinates = Eigen::VectorXd::LinSpaced(5, -1, 2);
    const Eigen::VectorXd u = shapes * coordinates;
    const Points expected = stencils * Eigen::Map<const Points>(u.data(), 4, 3);
    ReducedSurface surface(stencils, shapes);
    EXPECT_EQ(surface.num_places(), 2);
    EXPECT_LT((surface.displacements(coordinates).cast<double>() - expected).norm(), 1e-5);
}

TEST(BadDynamics, IsNamed) {
    DynamicsOptions options;
    options.step = 0;
    EXPECT_THROW(SkinDynamics(scalar(1), scalar(1), options), InvalidInput);
    EXPECT_THROW(SkinDynamics(chain(3, 1), unit(2)), InvalidInput);
    EXPECT_THROW(SkinDynamics(scalar(-1e9), scalar(1)), InvalidInput);
    SkinDynamics masses(chain(3, 1), unit(3));
    EXPECT_THROW(masses.advance(one(1)), InvalidInput);
    EXPECT_THROW(vibration_modes(chain(3, 1), unit(3), 3), InvalidInput);
    EXPECT_THROW(ReducedSkin(chain(3, 1), unit(3), Eigen::MatrixXd::Zero(3, 1), 0), InvalidInput);
    EXPECT_THROW(ReducedSkin(chain(3, 1), unit(3), Eigen::MatrixXd::Ones(2, 1), 0), InvalidInput);
    EXPECT_THROW(ReducedSkin(chain(3, 1), unit(3), Eigen::MatrixXd::Ones(3, 1), -1), InvalidInput);
    EXPECT_THROW(ReducedSkin(chain(3, 1), unit(3), Eigen::MatrixXd::Ones(3, 1), 3), InvalidInput);
    EXPECT_THROW(ReducedSurface(SparseRows(2, 4), Eigen::MatrixXd::Ones(11, 2)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
