// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/locate/landmarks.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

const Points2 kReference = (Points2(4, 2) << -0.5, 0, 0.5, 0, 0, 0.7, 0, 1.2).finished();

/// Blobs of different size about a place, under a turn, a size and an exposure.
struct Picture {
    static constexpr int kSide = 220;
    std::vector<std::uint8_t> pixels;

    Picture(const Eigen::Matrix<double, 2, 3>& image_from_face, double gain, double offset) {
        const Eigen::Matrix2d back = image_from_face.leftCols<2>().inverse();
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const Eigen::Vector2d p = back * (Eigen::Vector2d(x, y) - image_from_face.col(2));
                double value = 0.2 * p.x();
                for (int i = 0; i < kReference.rows(); ++i) {
                    const Eigen::Vector2d off = p - kReference.row(i).transpose();
                    value -= std::exp(-off.squaredNorm() / (0.02 + 0.02 * i)) * (1 + 0.3 * i);
                }
                const auto level =
                    static_cast<std::uint8_t>(std::clamp(170 + offset + gain * 60 * value, 0.0, 255.0));
                pixels.insert(pixels.end(), 3, level);
            }
        }
    }
    ColorView view() const { return {pixels.data(), kSide, kSide, 3 * kSide}; }
};

Eigen::Matrix<double, 2, 3> placed(double size, double turn, const Eigen::Vector2d& at) {
    Eigen::Matrix<double, 2, 3> out;
    out.leftCols<2>() = size * Eigen::Rotation2Dd(turn).toRotationMatrix();
    out.col(2) = at;
    return out;
}

Points2 moved(const Eigen::Matrix<double, 2, 3>& by, const Points2& points) {
    return (points * by.leftCols<2>().transpose()).rowwise() + by.col(2).transpose();
}

LandmarkCascade cascade(const Eigen::Vector2d& shift) {
    LandmarkCascade out;
    out.names = {"pupil.R", "pupil.L", "nose_tip", "lip_upper"};
    out.reference = kReference;
    for (const double yaw : {-28.0, 0.0, 28.0}) {
        Points2 start = kReference;
        start(2, 0) += yaw / 100;
        out.views.push_back({yaw, start, Eigen::VectorXd::Constant(4, 0.01 + 0.001 * std::abs(yaw))});
    }
    LandmarkStage stage{0.15, Eigen::VectorXd::Zero(kDescriptor), MatrixRows::Identity(2, kDescriptor), {}};
    stage.regression = MatrixRows::Zero(8, 9);
    for (int i = 0; i < 8; ++i) stage.regression(i, 8) = shift[i % 2];
    out.stages = {stage};
    return out;
}

TEST(Landmarks, SimilarityIsFound) {
    const auto by = placed(37, 0.4, {80, 60});
    EXPECT_TRUE(similarity(kReference, moved(by, kReference)).isApprox(by, 1e-12));
}

TEST(Landmarks, DescriptorsDoNotDependOnSizeTurnAndExposure) {
    const auto one = placed(40, 0, {110, 80}), other = placed(62, 0.35, {125, 70});
    const Picture plain(one, 1, 0), bright(other, 0.6, 30);
    const MatrixRows a = landmark_descriptors(plain.view(), moved(one, kReference), kReference, 0.15);
    const MatrixRows b = landmark_descriptors(bright.view(), moved(other, kReference), kReference, 0.15);
    const Points2 beside = moved(one, kReference.rowwise() + Eigen::RowVector2d(0.2, 0.1));
    const MatrixRows c = landmark_descriptors(plain.view(), beside, kReference, 0.15);
    ASSERT_EQ(a.cols(), kDescriptor);
    EXPECT_LT((a - b).norm(), 0.2 * a.norm());
    EXPECT_GT((a - c).norm(), 0.4 * a.norm());
}

TEST(Landmarks, ShiftsAreInTheFacesOwnAxesAndSize) {
    const auto by = placed(50, 0.5, {110, 80});
    const Points2 start = moved(by, kReference);
    const auto found = find_landmarks(Picture(by, 1, 0).view(), cascade({0.1, 0.02}), start);
    const Points2 expected = moved(by, kReference.rowwise() + Eigen::RowVector2d(0.1, 0.02));
    EXPECT_TRUE(found.places.isApprox(expected, 1e-9));
    EXPECT_EQ(found.yaw, 0);
    EXPECT_NEAR(found.sigma_px(0), 0.01 * 50, 1e-9);
}

TEST(Landmarks, StartHasThePupilsWhereTheyAre) {
    const auto by = placed(50, 0.2, {110, 80});
    const Points2 truth = moved(by, kReference);
    const Points2 start = landmark_start(cascade({0, 0}), truth.row(0), truth.row(1), 20);
    EXPECT_TRUE(start.topRows<2>().isApprox(truth.topRows<2>(), 1e-9));
    const Eigen::Vector2d nose = by.leftCols<2>() * Eigen::Vector2d(0.28, 0.7) + by.col(2);
    EXPECT_TRUE(start.row(2).transpose().isApprox(nose, 1e-9));
}

TEST(Landmarks, WhatDoesNotFitIsRefused) {
    auto broken = cascade({0, 0});
    EXPECT_NO_THROW(broken.check());
    broken.stages[0].regression.resize(8, 8);
    EXPECT_THROW(broken.check(), InvalidInput);
    const Picture picture(placed(50, 0, {110, 80}), 1, 0);
    EXPECT_THROW(find_landmarks(picture.view(), cascade({0, 0}), Points2::Zero(3, 2)), InvalidInput);
    EXPECT_THROW(find_landmarks(picture.view(), cascade({0, 0}), Points2::Constant(4, 2, 50)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
