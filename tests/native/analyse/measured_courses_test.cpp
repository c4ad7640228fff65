// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/stored_evidence.hpp>
#include <random>

namespace mimetic {
namespace {

constexpr int kFrames = 60, kMuscles = 4, kTop = 32;
constexpr int kSize = 6 + kMuscles + 1;  // pose, muscles, one articulator
const Eigen::VectorXd frames = Eigen::VectorXd::LinSpaced(kFrames, 1, kFrames);
const Eigen::Vector4d first_two(1, 1, 0, 0);

PhaseShape slow_start() {
    PhaseShape shape;
    shape.amplitude = .4;
    shape.onset = 18.3;
    shape.rise = 12;
    shape.hold = 6;
    shape.exponent = 2.5;
    shape.release_time = 3;
    return shape;
}

/// Two muscles that fire in the proportion of 3 to 1, and pictures that say so; what was captured of them is
/// less by a dead zone below .2.
struct Capture {
    MatrixRows truth = MatrixRows::Zero(kFrames, kMuscles), captured = truth;
    Rows<float, Eigen::Dynamic> evidence{kFrames, kSize * (kSize + 3) / 2};

    explicit Capture(double noise = 0) {
        std::mt19937 random(4);
        std::normal_distribution<double> normal;
        for (int t = 0; t < kFrames; ++t) {
            const double mean = slow_start().value(frames[t]);
            truth(t, 0) = 1.5 * mean;
            truth(t, 1) = .5 * mean;
            captured.row(t) = truth.row(t);
            for (const int muscle : {0, 1}) {
                const double value = truth(t, muscle);
                captured(t, muscle) = value < .2 ? std::max(0., 2 * value - .2) : value;
            }
            Eigen::MatrixXd columns(3 * kSize, kSize);
            for (double& entry : columns.reshaped()) {
                entry = 10 * normal(random);
            }
            Eigen::VectorXd step(kSize);  // from what was captured to what the pictures show
            for (double& entry : step) {
                entry = noise * normal(random);
            }
            step[2] = .01;
            step.segment<kMuscles>(6) += truth.row(t).transpose() - captured.row(t).transpose();
            FrameEstimate estimate;
            estimate.information = columns.transpose() * columns;
            estimate.gradient = estimate.information * step;
            evidence.row(t) = pack_evidence(estimate).transpose();
        }
    }
};

Eigen::VectorXd mean_of(const MatrixRows& values) { return values.leftCols<2>().rowwise().mean(); }

TEST(MeasuredCourses, ThePicturesShowTheFootThatTheSmootherCuts) {
    const Capture capture;
    const MeasuredCourses courses(capture.captured, capture.evidence);
    const Eigen::VectorXd course = courses.course(first_two, 5, 50, kTop);
    EXPECT_GT((mean_of(capture.captured) - mean_of(capture.truth)).cwiseAbs().maxCoeff(), .04);
    EXPECT_LT((course - mean_of(capture.truth).segment(5, 46)).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(MeasuredCourses, OnsetAndExponentAreThoseOfThePictures) {
    const Capture capture(.003);
    const MeasuredCourses courses(capture.captured, capture.evidence);
    const Eigen::VectorXd curve = mean_of(capture.captured), stds = Eigen::VectorXd::Constant(kFrames, .05);
    const std::vector<bool> all(kFrames, true);
    const PhaseShape truth = slow_start();
    const auto fits = fit_phases(frames, curve, stds, all, {}, {&courses, first_two});
    ASSERT_EQ(fits.size(), 1U);
    EXPECT_NEAR(fits[0].onset.value, truth.onset, .5);
    EXPECT_NEAR(fits[0].exponent.value, truth.exponent, .3);
    EXPECT_NEAR(fits[0].release.value, truth.release(), .2);
    const PhaseFit smoothed = fit_phases(frames, curve, stds, all).at(0);
    EXPECT_GT(smoothed.onset.value, truth.onset + 1);
}

TEST(MeasuredCourses, AFrameWithoutEvidenceHasWhatWasCaptured) {
    Capture capture;
    capture.evidence.row(20).setZero();
    const MeasuredCourses courses(capture.captured, capture.evidence);
    EXPECT_EQ(courses.course(first_two, 20, 40, kTop)[0], mean_of(capture.captured)[20]);
    EXPECT_TRUE(courses.course(Eigen::Vector4d(0, 0, 1, 1), 5, 50, kTop).isZero());  // silent
}

TEST(MeasuredCourses, WrongInputIsRefused) {
    const Capture capture;
    EXPECT_THROW(MeasuredCourses(capture.captured, capture.evidence.leftCols(20)), InvalidInput);
    EXPECT_THROW(MeasuredCourses(capture.captured.topRows(9), capture.evidence), InvalidInput);
    MatrixRows endless = capture.captured;
    endless(0, 0) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(MeasuredCourses(endless, capture.evidence), InvalidInput);
    const MeasuredCourses courses(capture.captured, capture.evidence);
    EXPECT_THROW(courses.course(Eigen::Vector3d::Ones(), 5, 50, kTop), InvalidInput);
    EXPECT_THROW(courses.course(first_two, 5, kFrames, kTop), InvalidInput);
    EXPECT_THROW(courses.course(first_two, 5, 30, kTop), InvalidInput);
    const Eigen::VectorXd few = frames.head(30);
    EXPECT_THROW(fit_phases(few, few, few, std::vector<bool>(30, true), {}, {&courses, first_two}),
                 InvalidInput);
}

}  // namespace
}  // namespace mimetic
