// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/covariance.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

namespace mimetic {
namespace {

Rotations about(const Points& vectors) {
    Rotations rotations;
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        rotations.push_back(rotation_from_vector(vectors.row(i).transpose()));
    }
    return rotations;
}

TEST(Rotations, VectorsGoOnPastHalfATurn) {
    const Eigen::RowVector3d axis(.6, 0, .8);
    Points vectors(60, 3);
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        vectors.row(i) = 5. / 59 * static_cast<double>(i) * axis;
    }
    const Rotations rotations = about(vectors);
    EXPECT_LT((rotation_vectors(rotations) - vectors).cwiseAbs().maxCoeff(), 1e-12);
    const Rows<double, 4> turns = quaternions(rotations);
    for (Eigen::Index i = 1; i < turns.rows(); ++i) {
        EXPECT_GT(turns.row(i).dot(turns.row(i - 1)), .9);
    }
}

TEST(Rotations, InverseJacobianMeetsFiniteDifferences) {
    constexpr double kStep = 1e-6;
    for (const Eigen::Vector3d& vector : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-4, 0, 2e-4),
                                          Eigen::Vector3d(.5, -1, .3), Eigen::Vector3d(-2, 1, 1.5)}) {
        const Eigen::Matrix3d jacobian = inverse_left_jacobian(vector);
        for (int axis = 0; axis < 3; ++axis) {
            const Rotations pair{
                rotation_from_vector(vector),
                rotation_from_vector(kStep * Eigen::Vector3d::Unit(axis)) * rotation_from_vector(vector)};
            const Points moved = rotation_vectors(pair);
            const Eigen::Vector3d numeric = (moved.row(1) - moved.row(0)).transpose() / kStep;
            EXPECT_LT((numeric - jacobian.col(axis)).norm(), 1e-5);
        }
    }
}

TEST(Rotations, EulerAnglesTurnInTheirOrder) {
    const Eigen::Vector3d vector(.3, -.7, .4);
    const Rotations rotations{rotation_from_vector(vector)};
    for (const std::string order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}) {
        const Points angles = euler_angles(rotations, order);
        Eigen::Matrix3d composed = Eigen::Matrix3d::Identity();
        for (const char letter : order) {
            const int axis = letter - 'X';
            composed = rotation_from_vector(angles(0, axis) * Eigen::Vector3d::Unit(axis)) * composed;
        }
        EXPECT_LT((composed - rotations[0]).norm(), 1e-12) << order;
    }
    EXPECT_THROW(euler_angles(rotations, "XYX"), InvalidInput);
}

TEST(Rotations, MeanIsBetweenThem) {
    Points vectors = Points::Zero(2, 3);
    vectors.col(1) << -.2, .6;
    const Eigen::Matrix3d expected = rotation_from_vector(Eigen::Vector3d(0, .2, 0));
    EXPECT_LT((mean_rotation(about(vectors)) - expected).norm(), 1e-12);
}

TEST(Covariance, NextToASpoiltOneIsSymmetricAndPositive) {
    Eigen::MatrixXd spoilt(2, 2);
    spoilt << 1e-8, 1.1e-5, .9e-5, 1e-2;  // radians beside metres; a correlation of 1
    const Eigen::MatrixXd mended = nearest_covariance(spoilt);
    EXPECT_EQ(mended(0, 1), mended(1, 0));
    EXPECT_GT(mended.determinant(), 0);
    EXPECT_NEAR(mended(0, 0), 1e-8, 1e-12);
    EXPECT_NEAR(mended(1, 1), 1e-2, 1e-6);
}

}  // namespace
}  // namespace mimetic
