// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/solve/relief.hpp>

#include "sighted_face.hpp"

namespace mimetic {
namespace {

using test::SightedFace;

struct Relief : testing::Test {
    SightedFace face;
    FittedSkin skin = face.skin();
    // The depth of the whole patch is held through points at its rim, which no bump moves
    ReliefModel model{face.bumps(.002),
                      MatrixRows::Zero(1, face.neutral.size()),
                      Eigen::VectorXd::Ones(1),
                      {0, SightedFace::kSide},
                      {0, SightedFace::kSide, 6}};

    std::vector<Sighting> sightings(const Eigen::VectorXd& truth, double slip = 0) const {
        const Eigen::VectorXd moved = model.components.transpose() * truth;
        const Points change = Eigen::Map<const Points>(moved.data(), face.neutral.rows(), 3);
        std::vector<Sighting> seen;
        // Points of the reference frame's rays: where the shape moves, they slide along these, so that the
        // frame itself shows nothing
        for (int i = 0; i < 12; ++i) {
            Sighting one = face.sighting(i, face.turned(.02 * (i + 1)), change, slip);
            const Sighting straight = face.sighting(100, face.reference, change);
            const Sighting fitted = face.sighting(100, face.reference, Points::Zero(change.rows(), 3));
            one.pixels -= straight.pixels - fitted.pixels;
            seen.push_back(one);
        }
        return seen;
    }
};

TEST_F(Relief, TurnedFramesTellHowDeepTheFaceIs) {
    const Eigen::VectorXd truth = Eigen::Vector4d(1.2, -.8, -1, .6);
    const Eigen::VectorXd found = find_relief(skin, model, sightings(truth));
    EXPECT_LT((found - truth).norm(), .5 * truth.norm());
    EXPECT_GT(found.dot(truth) / (found.norm() * truth.norm()), .9);
}

TEST_F(Relief, WhatErrsAlikeInAllFramesIsHardlyDepth) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(4);
    const auto taken_for_depth = [&](const ReliefOptions& options) {
        return (find_relief(skin, model, sightings(none, 1), options) -
                find_relief(skin, model, sightings(none, 0), options))
            .norm();
    };
    ReliefOptions unaware;
    unaware.lasting_error = 1e-9;
    EXPECT_LT(taken_for_depth({}), .75 * taken_for_depth(unaware));
}

TEST_F(Relief, StopsWhenToldAndRefusesAnotherSkin) {
    const auto seen = sightings(Eigen::VectorXd::Zero(4));
    EXPECT_EQ(find_relief(skin, model, seen, {}, [](double) { return false; }).size(), 0);
    model.landmarks = {int(face.neutral.rows())};
    EXPECT_THROW(find_relief(skin, model, seen), InvalidInput);
}

}  // namespace
}  // namespace mimetic
