// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/solve/error_field.hpp"

#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>

#include "sighted_face.hpp"

namespace mimetic {
namespace {

using test::SightedFace;

TEST(Sightings, PointsMoveWithTheirTriangles) {
    const SightedFace face;
    const FittedSkin skin = face.skin();
    const MatrixRows modes = face.bumps(.004);
    const Sighting seen = face.sighting(1, face.reference, Points::Zero(face.neutral.rows(), 3));
    const MatrixRows moved = modes_at(skin.stencils, seen.vertices, seen.barycentric, modes);
    const Points refined = skin.stencils * Eigen::Map<const Points>(modes.row(2).data(), modes.cols() / 3, 3);
    for (Eigen::Index k = 0; k < seen.vertices.rows(); ++k) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const int vertex : seen.vertices.row(k)) {
            mean += refined.row(vertex).transpose() / 3;
        }
        EXPECT_LT((moved.middleRows<3>(3 * k).col(2) - mean).norm(), 1e-15);
    }
    Triangles beyond = seen.vertices;
    beyond(0, 0) = int(skin.stencils.rows());
    EXPECT_THROW(modes_at(skin.stencils, beyond, seen.barycentric, modes), InvalidInput);
}

TEST(Sightings, PointsSeenAgainAreKeptOnce) {
    const SightedFace face;
    const Sighting all = face.sighting(1, face.reference, Points::Zero(face.neutral.rows(), 3));
    Sighting fewer = all;
    std::vector<int> backwards;
    for (int k = int(all.vertices.rows()) - 1; k >= 0; k -= 2) {
        backwards.push_back(k);
    }
    fewer.vertices = all.vertices(backwards, Eigen::all).eval();
    fewer.barycentric = all.barycentric(backwards, Eigen::all).eval();
    const DistinctPoints points = distinct_points({all, fewer});
    EXPECT_EQ(points.vertices.rows(), all.vertices.rows());
    const std::vector<Sighting> both{all, fewer};
    for (std::size_t i = 0; i < both.size(); ++i) {
        EXPECT_EQ(points.vertices(points.index[i], Eigen::all), both[i].vertices);
        EXPECT_EQ(points.barycentric(points.index[i], Eigen::all), both[i].barycentric);
    }
}

TEST(Sightings, ATrackersPointsStandForAllThatSayAnything) {
    SkinObservations seen{Triangles::Zero(1000, 3), Points::Zero(1000, 3), Points2::Zero(1000, 2),
                          Rows<double, 4>::Zero(1000, 4)};
    seen.information.topRows(900).col(0).setOnes();
    FrameEstimate estimate;
    estimate.values = Eigen::VectorXd::Zero(2);
    const Sighting kept = make_sighting(7, estimate, seen);
    EXPECT_EQ(kept.frame, 7);
    EXPECT_EQ(kept.pixels.rows(), 300);
    EXPECT_DOUBLE_EQ(kept.information.sum(), 900);
}

TEST(Sightings, DisplacementsAreThoseOfTheSkinWhateverTheStateGiven) {
    const SightedFace face;
    const FittedSkin skin = face.skin();
    const MatrixRows modes = face.bumps(.01);
    const Points change = Eigen::Map<const Points>(modes.row(1).data(), face.neutral.rows(), 3);
    const Eigen::VectorXd values = Eigen::Vector4d(0, 1, 0, 0);
    const Sighting seen = face.sighting(1, face.turned(.1), change, 0, values);
    const Eigen::Map<const MatrixRows> neutral(skin.neutral.data(), 1, skin.neutral.size());
    const MatrixRows rest = modes_at(skin.stencils, seen.vertices, seen.barycentric, neutral);
    const MatrixRows by_mode = modes_at(skin.stencils, seen.vertices, seen.barycentric, modes);
    const WeighedSighting weighed = weigh(seen, rest.col(0), by_mode, skin);
    const Eigen::VectorXd left = weighed.displacement - weighed.in_picture(by_mode) * values;
    EXPECT_NEAR(left.squaredNorm() / double(left.size()), 1, .25);  // noise of unit variance alone
    EXPECT_GT(weighed.displacement.norm(), 3 * left.norm());
}

TEST(ErrorField, HasUnitVarianceWhereNodesReach) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 40; ++i) {
        points.emplace_back(.003 * i, .001 * (i % 3), 0);
    }
    const ErrorField<double> field(points);
    EXPECT_GE(field.num_nodes(), 5u);
    for (const auto& point : points) {
        double variance = 0;
        for (const auto& [node, height] : field.near(point)) {
            variance += height * height;
        }
        EXPECT_NEAR(variance, 1, 1e-6);
    }
}

}  // namespace
}  // namespace mimetic
