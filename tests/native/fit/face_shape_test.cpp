// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cstdlib>
#include <mimetic/fit/face_shape.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Symmetric compliance of an elastic chain of S points between two walls.
Eigen::MatrixXd compliance_of_chain(int num_points) {
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(3 * num_points, 3 * num_points);
    for (int i = 0; i < num_points; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            stiffness(3 * i + axis, 3 * i + axis) = 2 + axis;
            if (i > 0) {
                stiffness(3 * i + axis, 3 * i + axis - 3) = stiffness(3 * i + axis - 3, 3 * i + axis) = -1;
            }
        }
    }
    return stiffness.inverse();
}

TEST(PrincipalShapes, AreApartAndFallAndTurnedOneWay) {
    std::srand(3);
    const MatrixRows deformations = Eigen::MatrixXd::Random(5, 18);
    const std::vector<int> seen{0, 2, 3, 5};
    const PrincipalShapes shapes = principal_shapes(deformations, seen, 4);
    ASSERT_EQ(shapes.shares.cols(), 4);
    MatrixRows on_seen(4, 12);
    const MatrixRows all = shapes.shares.transpose() * deformations;
    for (int i = 0; i < 4; ++i) {
        on_seen.middleCols<3>(3 * i) = all.middleCols<3>(3 * seen[static_cast<std::size_t>(i)]);
    }
    const Eigen::MatrixXd gram = on_seen * on_seen.transpose();
    EXPECT_LT((gram - Eigen::MatrixXd(shapes.variances.asDiagonal())).norm(), 1e-12);
    for (int k = 0; k < 4; ++k) {
        EXPECT_GT(shapes.shares.col(k).maxCoeff(), -shapes.shares.col(k).minCoeff());
        EXPECT_TRUE(k == 0 || shapes.variances[k] <= shapes.variances[k - 1]);
    }
    EXPECT_THROW(principal_shapes(deformations, {6}, 2), InvalidInput);
}

TEST(PairedPulls, AreAlikeOrOpposedUnderTheMirror) {
    Points skin(4, 3);
    skin << .02, 0, 0, -.02, 0, 0, 0, .03, 0, 0, -.03, 0;
    const std::vector<int> mirror{1, 0, 2, 3};
    for (const int parity : {1, -1}) {
        const MatrixRows pulls = paired_pulls(skin, {0, 2}, std::vector<bool>(4, true), .008, parity);
        // On the midline, a pull across cannot be alike on both sides, nor one along opposed
        ASSERT_EQ(pulls.rows(), parity == 1 ? 5 : 4);
        for (Eigen::Index i = 0; i < pulls.rows(); ++i) {
            for (int v = 0; v < 4; ++v) {
                const int other = mirror[static_cast<std::size_t>(v)];
                EXPECT_NEAR(pulls(i, 3 * v), -parity * pulls(i, 3 * other), 1e-15);
                EXPECT_NEAR(pulls(i, 3 * v + 1), parity * pulls(i, 3 * other + 1), 1e-15);
            }
        }
    }
}

TEST(ElasticModes, AreThosePrincipalOfTheWholePriorWherePullsReachEverything) {
    constexpr int kPoints = 6;
    const Eigen::MatrixXd compliance = compliance_of_chain(kPoints);
    const MatrixRows pulls = Eigen::MatrixXd::Identity(3 * kPoints, 3 * kPoints);
    const MatrixRows responses = compliance;
    std::vector<int> all(kPoints);
    for (int i = 0; i < kPoints; ++i) {
        all[static_cast<std::size_t>(i)] = i;
    }
    // A unit of energy each: their covariance is the compliance, whose principal components these are
    const MatrixRows modes = elastic_modes(pulls, responses, all, .001, .1);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(compliance);
    for (Eigen::Index k = 0; k < modes.rows(); ++k) {
        const Eigen::VectorXd direction = eigen.eigenvectors().col(3 * kPoints - 1 - k);
        EXPECT_NEAR(std::abs(direction.dot(modes.row(k))) / modes.row(k).norm(), 1, 1e-9);
    }
    EXPECT_NEAR(std::sqrt(modes.squaredNorm() / (3 * kPoints)), .001, 1e-12);
    EXPECT_LT(modes.rows(), 3 * kPoints);
    EXPECT_THROW(elastic_modes(pulls, -responses, all, .001, .1), InvalidInput);
}

TEST(NearestCoefficients, AreTheShortestInLeastSquares) {
    std::srand(5);
    MatrixRows matrix = Eigen::MatrixXd::Random(7, 4);
    matrix.col(3).setZero();  // says nothing: its coefficient is 0
    const Eigen::VectorXd values = Eigen::VectorXd::Random(7);
    const Eigen::VectorXd found = nearest_coefficients(matrix, values);
    EXPECT_NEAR(found[3], 0, 1e-12);
    EXPECT_LT((matrix.transpose() * (matrix * found - values)).norm(), 1e-12);
    EXPECT_THROW(nearest_coefficients(matrix, values.head(3)), InvalidInput);
}

TEST(SlidingOnEyeball, ALidThatSlidesKeepsItsDistanceFromTheEyeballsCentre) {
    const Eigen::Vector3d centre(0.03, 0.02, 0.05);
    Points skin(3, 3);
    skin << 0.03, 0.026, 0.0604, 0.033, 0.014, 0.06, 0.03, 0.08, 0.06;  // two on the margin, one far off
    MatrixRows modes(1, 9);
    modes << 0.0002, 0.001, 0.004, -0.0005, 0.001, 0, 0.0001, 0.001, 0.002;
    const MatrixRows sliding = sliding_on_eyeball(modes, skin, {0, 1}, centre, 0.005, 0.5);
    for (int v = 0; v < 2; ++v) {
        const Eigen::Vector3d arm = skin.row(v).transpose() - centre,
                              moved = sliding.row(0).segment<3>(3 * v);
        EXPECT_NEAR(moved.dot(arm), 0, 1e-12);
        EXPECT_EQ(moved.head<2>(), modes.row(0).segment<2>(3 * v).transpose());
    }
    EXPECT_NEAR(sliding(0, 8), 0.002, 1e-9);
    EXPECT_THROW(sliding_on_eyeball(modes, skin, {3}, centre, 0.005, 0.5), InvalidInput);
    EXPECT_THROW(sliding_on_eyeball(modes, skin.topRows(2), {0}, centre, 0.005, 0.5), InvalidInput);
}

}  // namespace
}  // namespace mimetic
