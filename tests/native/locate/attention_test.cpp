// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/locate/attention.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/locate/feature_networks.hpp>

namespace mimetic::locate {
namespace {

/// All points in the middle of the crop but those of a mouth as wide as 0.2, as high as 0.1, turned by 0.3.
Points2 turned_mouth() {
    Points2 mesh = Points2::Constant(MeshPoints::kCount, 2, 0.5);
    const Eigen::Rotation2Dd turn(0.3);
    const auto put = [&](int point, double x, double y) {
        mesh.row(point) = (Eigen::Vector2d(0.5, 0.6) + turn * Eigen::Vector2d(x, y)).transpose();
    };
    for (const int point : kLipsPart.points) put(point, 0, 0);
    put(61, -0.1, 0);
    put(291, 0.1, 0);
    put(0, 0.02, -0.06);
    put(17, 0, 0.04);
    return mesh;
}

TEST(Attention, ASquareIsOneAndAHalfTimesTheBoxAndLiesLevel) {
    const PartSquare square = square_of(kLipsPart, turned_mouth());
    EXPECT_NEAR(square.col(0).norm(), 1.5 * 0.2, 1e-12);
    EXPECT_NEAR(square.col(1).norm(), 1.5 * 0.1, 1e-12);
    EXPECT_NEAR(std::atan2(square(1, 0), square(0, 0)), 0.3, 1e-12);
    const Eigen::Vector2d middle = square * Eigen::Vector3d(0.5, 0.5, 1);
    const Eigen::Vector2d wanted =
        Eigen::Vector2d(0.5, 0.6) + Eigen::Rotation2Dd(0.3) * Eigen::Vector2d(0, -0.01);
    EXPECT_LT((middle - wanted).norm(), 1e-12);
}

/// Maps that say their own places: a plane of x and one of y, in sides of the crop.
cv::Mat places_in_maps(int side) {
    const int shape[] = {1, 2, side, side};
    cv::Mat maps(4, shape, CV_32F);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            maps.ptr<float>(0, 0)[y * side + x] = static_cast<float>((x + 0.5) / side);
            maps.ptr<float>(0, 1)[y * side + x] = static_cast<float>((y + 0.5) / side);
        }
    }
    return maps;
}

TEST(Attention, AHeadSeesTheMapsWhereItsSquareLies) {
    const PartSquare square = square_of(kLipsPart, turned_mouth());
    const cv::Mat seen = seen_in(places_in_maps(48), square);
    ASSERT_EQ(seen.total(), 2u * 16 * 16);
    for (int i = 0; i < 256; ++i) {
        const Eigen::Vector2d place = square * Eigen::Vector3d((i % 16 + 0.5) / 16, (i / 16 + 0.5) / 16, 1);
        EXPECT_NEAR(seen.ptr<float>()[i], place.x(), 1e-6);
        EXPECT_NEAR(seen.ptr<float>()[256 + i], place.y(), 1e-6);
    }
}

TEST(Attention, BesideTheMapsThereIsNothing) {
    PartSquare square;
    square << 1, 0, 0.5, 0, 1, 0;  // half of it to the right of the crop
    const cv::Mat seen = seen_in(places_in_maps(48), square);
    EXPECT_GT(seen.ptr<float>()[7], 0.9);
    EXPECT_EQ(seen.ptr<float>()[8], 0);
    square << 0, 0, 0, 0, 0, std::nan("");
    EXPECT_EQ(cv::countNonZero(seen_in(places_in_maps(48), square).reshape(1, 1)), 0);
}

TEST(Attention, WhatAHeadSaysGoesBackThroughItsSquare) {
    const PartSquare square = square_of(kLipsPart, turned_mouth());
    const cv::Mat said = (cv::Mat1f(1, 4) << 0, 0, 64, 32);  // a corner, and the middle of the far side
    const Points2 points = points_of(said, square);
    EXPECT_LT((points.row(0).transpose() - square.col(2)).norm(), 1e-12);
    EXPECT_LT((points.row(1).transpose() - square * Eigen::Vector3d(1, 0.5, 1)).norm(), 1e-12);
}

}  // namespace
}  // namespace mimetic::locate
