// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>
#include <mimetic/solve/relief.hpp>

#include "sighted_face.hpp"

namespace mimetic {
namespace {

using test::SightedFace;

struct FindRelief : testing::Test {
    SightedFace face;
    FittedSkin skin = face.skin();
    // The depth of the whole patch is held through points at its rim, which no bump moves
    ReliefModel model{face.bumps(.002),
                      {},
                      MatrixRows::Zero(1, face.neutral.size()),
                      Eigen::VectorXd::Ones(1),
                      {0, SightedFace::kSide},
                      {0, SightedFace::kSide, 6},
                      {},
                      {}};

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

TEST_F(FindRelief, TurnedFramesTellHowDeepTheFaceIs) {
    const Eigen::VectorXd truth = Eigen::Vector4d(1.2, -.8, -1, .6);
    const Eigen::VectorXd found = find_relief(skin, model, sightings(truth)).coefficients;
    EXPECT_LT((found - truth).norm(), .5 * truth.norm());
    EXPECT_GT(found.dot(truth) / (found.norm() * truth.norm()), .9);
}

TEST_F(FindRelief, WhatErrsAlikeInAllFramesIsHardlyDepth) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(4);
    const auto taken_for_depth = [&](const ReliefOptions& options) {
        return (find_relief(skin, model, sightings(none, 1), options).coefficients -
                find_relief(skin, model, sightings(none, 0), options).coefficients)
            .norm();
    };
    ReliefOptions unaware;
    unaware.lasting_error = 1e-9;
    EXPECT_LT(taken_for_depth({}), .75 * taken_for_depth(unaware));
}

TEST_F(FindRelief, WhatIsSeenAslantTellsLess) {
    const Eigen::VectorXd truth = Eigen::Vector4d(1.2, -.8, -1, .6);
    std::vector<Sighting> seen = sightings(truth);
    // Flow near an outline follows the outline, which stays where it is
    for (Sighting& one : seen) {
        for (Eigen::Index k = 0; k < one.pixels.rows(); ++k) {
            const Eigen::RowVector3d normal = skin.normals.row(one.vertices(k, 0));
            const Eigen::Vector3d place = skin.stencils.row(one.vertices(k, 0)) * skin.neutral;
            const Eigen::Vector3d to_camera = one.camera_from_head.inverse().translation() - place;
            if (normal.dot(to_camera.normalized()) < .4) {
                one.pixels(k, 0) += normal.x() > 0 ? 2 : -2;
            }
        }
    }
    const auto error = [&](const ReliefOptions& options) {
        return (find_relief(skin, model, seen, options).coefficients - truth).norm();
    };
    ReliefOptions unaware;
    unaware.grazing = 1e-9;
    EXPECT_LT(error({}), .6 * truth.norm());
    EXPECT_LT(error({}), .7 * error(unaware));
}

/// The same shapes as heights along the rays, and no usual proportions that could stand for them.
ReliefModel only_bumps(const ReliefModel& model) {
    ReliefModel bumps = model;
    bumps.components = MatrixRows::Zero(1, model.components.cols());
    bumps.bumps.resize(model.components.rows(), model.components.cols() / 3);
    for (Eigen::Index v = 0; v < bumps.bumps.cols(); ++v) {
        bumps.bumps.col(v) = model.components.col(3 * v + 2);
    }
    return bumps;
}

TEST_F(FindRelief, BumpsTakeWhatNoProportionsHave) {
    const Eigen::VectorXd truth = Eigen::Vector4d(1.2, -.8, -1, .6);
    const Eigen::VectorXd found = find_relief(skin, only_bumps(model), sightings(truth)).coefficients.tail(4);
    // A bump's height counts away from the camera
    EXPECT_LT((found + truth).norm(), .5 * truth.norm());
}

TEST_F(FindRelief, GoesOnFromWhatTheSkinHasAlready) {
    const Eigen::VectorXd truth = Eigen::Vector4d(.6, -.4, -.5, .3);
    const Relief whole = find_relief(skin, model, sightings(2 * truth));
    const Eigen::VectorXd moved = model.components.transpose() * truth;
    const Points half_way = face.neutral + Eigen::Map<const Points>(moved.data(), face.neutral.rows(), 3);
    const FittedSkin ahead(SubdividedMesh(face.quads, int(face.neutral.rows()), 1), half_way, face.camera,
                           face.reference);
    model.start = truth;
    const Relief further = find_relief(ahead, model, sightings(2 * truth));
    EXPECT_LT((further.coefficients - whole.coefficients).norm(), .35 * whole.coefficients.norm());
}

TEST_F(FindRelief, SaysHowWellDepthIsKnown) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(4);
    model.spread = {4 * (SightedFace::kSide + 1) + 3, 9 * (SightedFace::kSide + 1) + 9};
    model.judged = model.spread;
    std::vector<Sighting> still;
    for (int i = 0; i < 12; ++i) {
        still.push_back(face.sighting(i, face.reference, Points::Zero(face.neutral.rows(), 3)));
    }
    const double turned = find_relief(skin, model, sightings(none)).depth_std.maxCoeff();
    EXPECT_GT(turned, 0);
    EXPECT_LT(turned, .8 * find_relief(skin, model, still).depth_std.maxCoeff());
}

/// The face's right half is seen by flow, of its left half only the outline.
TEST_F(FindRelief, OutlinesTellOfDepthAcrossThem) {
    const Eigen::VectorXd truth = Eigen::Vector4d(1.2, 0, -1, 0);  // bumps of the half with x < 0
    std::vector<Sighting> seen = sightings(truth), flow_alone = seen, by_flow = seen;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        std::vector<int> right, order;
        for (int k = 0; k < seen[i].pixels.rows(); ++k) {
            const double x = (skin.stencils * face.neutral)(seen[i].vertices(k, 0), 0);
            (x > 0 ? right : order).push_back(k);
        }
        const std::vector<int> left = order;
        order = right;
        order.insert(order.end(), left.begin(), left.end());
        const auto taken = [](const Sighting& from, const std::vector<int>& rows) {
            Sighting one = from;
            one.vertices = from.vertices(rows, Eigen::all);
            one.barycentric = from.barycentric(rows, Eigen::all);
            one.pixels = from.pixels(rows, Eigen::all);
            one.information = from.information(rows, Eigen::all);
            return one;
        };
        flow_alone[i] = taken(by_flow[i], right);
        seen[i] = taken(by_flow[i], order);
        seen[i].num_outline = int(left.size());
        // Across an upright outline alone
        seen[i].information.bottomRows(seen[i].num_outline).rowwise() = Eigen::RowVector4d(100, 0, 0, 0);
    }
    const auto left = [&](const std::vector<Sighting>& all) {
        return (find_relief(skin, model, all).coefficients - truth).norm();
    };
    EXPECT_LT(left(seen), .7 * left(flow_alone));
    seen.front().num_outline = int(seen.front().pixels.rows()) + 1;
    EXPECT_THROW(find_relief(skin, model, seen), InvalidInput);
}

TEST_F(FindRelief, RaysMeetTheCamera) {
    const std::vector<int> vertices{0, 7};
    const Points rays = skin.rays_to(vertices);
    for (int i = 0; i < 2; ++i) {
        const Eigen::Vector3d away =
            skin.neutral.row(vertices[std::size_t(i)]).transpose() - skin.camera_place();
        EXPECT_NEAR((rays.row(i).transpose() * away.norm() - away).norm(), 0, 1e-12);
    }
    EXPECT_NEAR((skin.reference_pose * skin.camera_place()).norm(), 0, 1e-12);
    EXPECT_THROW(static_cast<void>(skin.rays_to({int(skin.neutral.rows())})), InvalidInput);
}

TEST_F(FindRelief, StopsWhenToldAndRefusesAnotherSkin) {
    const auto seen = sightings(Eigen::VectorXd::Zero(4));
    EXPECT_EQ(find_relief(skin, model, seen, {}, [](double) { return false; }).coefficients.size(), 0);
    model.landmarks = {int(face.neutral.rows())};
    EXPECT_THROW(find_relief(skin, model, seen), InvalidInput);
}

}  // namespace
}  // namespace mimetic
