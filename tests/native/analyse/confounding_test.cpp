// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <mimetic/analyse/confounding.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/stored_evidence.hpp>
#include <random>

namespace mimetic {
namespace {

constexpr int kMuscles = 4, kValues = kMuscles + 1;  // one articulator
constexpr int kSize = 6 + kValues;

/// A frame in which each value moves 60 measurements its own way, but those that are told to go with another.
/// noise: of a measurement, in units of what a value at 1 moves it.
class Frame {
public:
    explicit Frame(double noise = .25) : noise_(noise) {
        std::mt19937 random(7);
        std::normal_distribution<double> normal;
        for (double& entry : footprints_.reshaped()) {
            entry = normal(random);
        }
    }

    /// Value b moves what a moves, but for a share of its own.
    void alike(int a, int b, double own) {
        footprints_.col(6 + b) = footprints_.col(6 + a) + own * footprints_.col(6 + b);
    }

    Eigen::VectorXf evidence() const {
        FrameEstimate estimate;
        estimate.information = footprints_.transpose() * footprints_ / (noise_ * noise_);
        estimate.gradient = Eigen::VectorXd::Zero(kSize);
        return pack_evidence(estimate);
    }

private:
    double noise_;
    Eigen::MatrixXd footprints_{60, kSize};
};

Rows<int, Eigen::Dynamic> confounded(const Frame& frame, const Eigen::RowVector4d& activations,
                                     double std = .2) {
    return confounded_values(activations, Eigen::RowVector4d::Constant(std), frame.evidence().transpose());
}

const Eigen::RowVector4d all_at_work(.6, .5, .4, .3);

TEST(Confounding, MusclesThatMoveTheSameSkinCannotBeToldApart) {
    Frame frame;
    frame.alike(0, 2, .1);
    EXPECT_EQ(confounded(frame, all_at_work), Eigen::RowVector4i(2, -1, 0, -1));
}

TEST(Confounding, OnesThatMoveWhatIsTheirsCan) {
    EXPECT_EQ(confounded(Frame(), all_at_work), Eigen::RowVector4i::Constant(-1));
    Frame frame;
    frame.alike(0, 2, 2);
    EXPECT_EQ(confounded(frame, all_at_work), Eigen::RowVector4i::Constant(-1));
}

TEST(Confounding, AClearPictureTellsApartWhatANoisyOneDoesNot) {
    Frame noisy, clear(.01);
    noisy.alike(0, 2, .1);
    clear.alike(0, 2, .1);
    EXPECT_EQ(confounded(noisy, all_at_work)(0, 0), 2);
    EXPECT_EQ(confounded(clear, all_at_work, .01)(0, 0), -1);  // the deviation matters to no one
}

TEST(Confounding, WhatRestsMayBeTheOneAtWork) {
    Frame frame;
    frame.alike(0, 2, .1);
    EXPECT_EQ(confounded(frame, {.6, .5, 0, .3}), Eigen::RowVector4i(2, -1, 0, -1));
    EXPECT_EQ(confounded(frame, {0, .5, 0, .3}), Eigen::RowVector4i::Constant(-1));  // neither is
}

TEST(Confounding, AMuscleMayBeConfoundedWithTheJaw) {
    Frame frame;
    frame.alike(1, kMuscles, .1);
    EXPECT_EQ(confounded(frame, all_at_work), Eigen::RowVector4i(-1, kMuscles, -1, -1));
}

TEST(Confounding, NothingIsSaidOfAFrameWithoutEvidence) {
    const Eigen::RowVectorXf none = Eigen::RowVectorXf::Zero(kSize * (kSize + 3) / 2);
    EXPECT_EQ(confounded_values(all_at_work, Eigen::RowVector4d::Constant(.5), none),
              Eigen::RowVector4i::Constant(-1));
}

TEST(Confounding, WrongInputIsRefused) {
    const Eigen::RowVectorXf evidence = Frame().evidence().transpose();
    const Eigen::RowVector4d std = Eigen::RowVector4d::Constant(.2);
    EXPECT_THROW(confounded_values(all_at_work, std, evidence.head(20)), InvalidInput);
    EXPECT_THROW(confounded_values(all_at_work, std.head(3), evidence), InvalidInput);
    EXPECT_THROW(confounded_values(MatrixRows::Zero(2, 4), MatrixRows::Zero(2, 4), evidence), InvalidInput);
    Eigen::RowVector4d endless = all_at_work;
    endless[1] = std::numeric_limits<double>::infinity();
    EXPECT_THROW(confounded_values(endless, std, evidence), InvalidInput);
}

}  // namespace
}  // namespace mimetic
