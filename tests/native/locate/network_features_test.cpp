// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <mimetic/locate/network_features.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Networks that see two eyes 60 pixels apart, whose lids arch, and a mouth under them.
struct Seen {
    MeshPoints mesh;
    std::array<EyePoints, 2> eyes;

    Seen() {
        mesh.presence = 0.9;
        mesh.places = Points2::Zero(MeshPoints::kCount, 2);
        const auto lip = [&](std::initializer_list<int> line, double height) {
            int at = 0;
            for (const int index : line) {
                mesh.places.row(index) << 80 + 4 * at, 160 + height * at * (10 - at) / 25.0;
                ++at;
            }
        };
        lip({61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291}, -6);
        lip({61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291}, 8);
        lip({78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308}, -1);
        lip({78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308}, 1);
        mesh.places.row(263) << 142, 100;
        mesh.places.row(362) << 118, 100;
        mesh.places.row(133) << 82, 100;
        mesh.places.row(33) << 58, 100;
        for (std::size_t e = 0; e < 2; ++e) {
            const double outward = e == 0 ? 1 : -1, middle = 100 + 30 * outward;
            eyes[e].iris = Points2::Zero(EyePoints::kIris, 2).rowwise() + Eigen::RowVector2d(middle, 100);
            eyes[e].contour = Points2::Zero(EyePoints::kContour, 2);
            for (int i = 0; i <= 8; ++i) {
                const double along = 1 - i / 4.0;  // 1 at the outer corner
                eyes[e].contour.row(i) << middle + 12 * outward * along, 100 + 4 * (1 - along * along);
                if (i > 0 && i < 8)
                    eyes[e].contour.row(8 + i) << middle + 12 * outward * along,
                        100 - 6 * (1 - along * along);
            }
        }
    }
};

/// What a cascade says of the same face, 4 pixels lower.
FaceFeatures landmarks() {
    FaceFeatures face;
    for (const auto& [name, x, y] : {std::tuple{"pupil.L", 130., 104.},
                                     {"pupil.R", 70., 104.},
                                     {"eye_outer.L", 142., 104.},
                                     {"lid_upper.L", 130., 98.},
                                     {"lip_lower", 100., 172.},
                                     {"ala.L", 110., 140.}}) {
        face.features.push_back({name, {x, y}, 2, 1});
    }
    face.curves.push_back({"lip_line", Points2::Zero(1, 2), Points2::Ones(1, 2), Eigen::VectorXd::Ones(1)});
    face.curves.push_back({"jaw", Points2::Zero(1, 2), Points2::Ones(1, 2), Eigen::VectorXd::Ones(1)});
    return face;
}

TEST(NetworkFeatures, AreLinesAcrossTheMarginsWithoutTheirCorners) {
    const Seen seen;
    const FaceFeatures face = network_features(seen.mesh, seen.eyes);
    for (const char* name :
         {"lid_upper.L", "lid_lower.R", "lip_upper", "lip_upper_inner", "lip_lower_inner", "lip_lower"}) {
        const FeatureCurve* curve = face.find_curve(name);
        ASSERT_NE(curve, nullptr) << name;
        const Eigen::Index middle = curve->points.rows() / 2;
        EXPECT_NEAR(std::abs(curve->normals(middle, 1)), 1, 1e-9) << name;
        EXPECT_TRUE((curve->normals.rowwise().norm().array() - 1).abs().maxCoeff() < 1e-9) << name;
    }
    EXPECT_EQ(face.find_curve("lid_upper.L")->points.rows(), 7);
    EXPECT_NEAR(face.find_curve("lid_upper.L")->points(3, 1), 94, 1e-9);
    EXPECT_NEAR(face.find_curve("lip_upper")->points(4, 1), 154, 1e-9);
    EXPECT_NEAR(face.find("mouth_corner.L")->position.x(), 120, 1e-9);
    EXPECT_GT(face.find("pupil.L")->sigma_px, face.find_curve("lid_upper.L")->sigma_px(0));
}

TEST(NetworkFeatures, SeeTheLowerLipEndHigherMidwayThanTheNetworksDoInATurnedPictureToo) {
    const Seen seen;
    const FaceFeatures face = network_features(seen.mesh, seen.eyes);
    const FeatureCurve* edge = face.find_curve("lip_lower");
    const double raised = 168 - edge->points(4, 1);
    EXPECT_NEAR(raised, 0.012 * 60, 1e-9);
    EXPECT_LT(seen.mesh.places(375, 1) - edge->points(8, 1), 0.5 * raised);  // beside a corner
    EXPECT_GT(seen.mesh.places(375, 1) - edge->points(8, 1), 0);
    Seen turned = seen;  // a quarter: right becomes down, down left
    const auto turn = [](Points2& places) {
        places = (Points2(places.rows(), 2) << -places.col(1), places.col(0)).finished();
    };
    turn(turned.mesh.places);
    for (EyePoints& eye : turned.eyes) {
        turn(eye.iris);
        turn(eye.contour);
    }
    const FaceFeatures other_face = network_features(turned.mesh, turned.eyes);
    EXPECT_NEAR(other_face.find_curve("lip_lower")->points(4, 0), -edge->points(4, 1), 1e-9);
}

TEST(NetworkFeatures, AreSurestOfLipsMidway) {
    const Seen seen;
    const FaceFeatures face = network_features(seen.mesh, seen.eyes);
    for (const char* name : {"lip_upper", "lip_upper_inner", "lip_lower_inner", "lip_lower"}) {
        const Eigen::VectorXd& sigma = face.find_curve(name)->sigma_px;
        EXPECT_LT(sigma(4), 0.6 * sigma(0)) << name;
        EXPECT_NEAR(sigma(0), sigma(8), 1e-9) << name;
    }
}

TEST(NetworkFeatures, StandForTheLandmarksOfTheSameNamesAlone) {
    const Seen seen;
    const FaceFeatures joined = with_network_features(landmarks(), network_features(seen.mesh, seen.eyes));
    EXPECT_NEAR(joined.find("eye_outer.L")->position.y(), 100, 1e-9);
    EXPECT_EQ(joined.find("lid_upper.L"), nullptr);
    EXPECT_EQ(joined.find("lip_lower"), nullptr);
    EXPECT_NEAR(joined.find("ala.L")->position.y(), 140, 1e-9);
    EXPECT_EQ(joined.find_curve("lip_line"), nullptr);
    EXPECT_NE(joined.find_curve("jaw"), nullptr);
    const Feature* pupil = joined.find("pupil.L");  // between the two, nearer to the surer
    EXPECT_GT(pupil->position.y(), 101);
    EXPECT_LT(pupil->position.y(), 103.5);
    EXPECT_LT(pupil->sigma_px, 2);
}

TEST(EyeFeatures, LeaveTheMouthAndTheCornersToTheLandmarks) {
    Seen seen;
    seen.eyes[0].lid_doubt = 2;
    for (EyePoints& eye : seen.eyes) {
        eye.contour.conservativeResize(EyePoints::kRoundEye, Eigen::NoChange);
    }
    const FaceFeatures eyes = eye_features(seen.eyes, 1);
    EXPECT_NEAR(eyes.find_curve("lid_upper.L")->sigma_px(0) / eyes.find_curve("lid_upper.R")->sigma_px(0), 2,
                .1);
    const FaceFeatures joined = with_network_features(landmarks(), eyes);
    EXPECT_EQ(joined.find("lid_upper.L"), nullptr);
    EXPECT_EQ(joined.find_curve("lid_upper.L")->points, eyes.find_curve("lid_upper.L")->points);
    for (const char* name : {"lip_line", "jaw"}) {
        EXPECT_NE(joined.find_curve(name), nullptr) << name;
    }
    EXPECT_EQ(joined.find("eye_outer.L")->position, landmarks().find("eye_outer.L")->position);
    const FaceFeatures local = local_features(joined, 1);
    EXPECT_EQ(local.features.size(), 2U);  // the pupils
    EXPECT_EQ(local.find("eye_outer.L"), nullptr);
    seen.eyes[1].iris.resize(0, 2);
    EXPECT_THROW(eye_features(seen.eyes, 1), InvalidInput);
}

TEST(NetworkFeatures, AreLeftOutWhereNoFaceIsSeenOrAnother) {
    Seen seen;
    const FaceFeatures elsewhere = [&] {
        FaceFeatures face = landmarks();
        for (auto& feature : face.features) feature.position.x() += 40;
        return face;
    }();
    const FaceFeatures here = network_features(seen.mesh, seen.eyes);
    EXPECT_EQ(with_network_features(elsewhere, here).features.size(), elsewhere.features.size());
    EXPECT_EQ(with_network_features(elsewhere, here).curves.size(), 2U);
    seen.mesh.presence = 0.1;
    const FaceFeatures unsure = network_features(seen.mesh, seen.eyes);
    EXPECT_NE(with_network_features(landmarks(), unsure).find("lip_lower"), nullptr);
}

TEST(NetworkFeatures, OfAHeadThatMovesLocallyAreEyesAndMouthAloneWithTheOuterCornersWhereHandsMarkThem) {
    const Seen seen;
    const FaceFeatures joined = with_network_features(landmarks(), network_features(seen.mesh, seen.eyes));
    const FaceFeatures local = local_features(joined, 1);
    EXPECT_EQ(local.find("ala.L"), nullptr);
    EXPECT_EQ(local.find_curve("jaw"), nullptr);
    EXPECT_EQ(local.curves.size(), 8U);
    const double pupils = (local.find("pupil.L")->position - local.find("pupil.R")->position).norm();
    const Eigen::Vector2d left = local.find("eye_outer.L")->position,
                          right = local.find("eye_outer.R")->position;
    EXPECT_NEAR(left.x(), 142 + 0.026 * pupils, 1e-9);
    EXPECT_NEAR(right.x(), 58 - 0.026 * pupils, 1e-9);
    EXPECT_NEAR(left.y(), 100 + 0.017 * pupils, 1e-9);
    EXPECT_NEAR(right.y(), 100 + 0.017 * pupils, 1e-9);
    EXPECT_EQ(local.find("eye_inner.L")->position, joined.find("eye_inner.L")->position);
    const FeatureCurve* edge = local.find_curve("lip_upper");
    EXPECT_EQ(edge->points, joined.find_curve("lip_upper")->points);
    EXPECT_EQ(edge->sigma_px(0), edge->sigma_px(4));
    EXPECT_NEAR(local_features(joined, 4).find_curve("lip_upper")->sigma_px(0), 2 * edge->sigma_px(0), 1e-9);
    EXPECT_THROW(local_features(joined, 0), InvalidInput);
    EXPECT_TRUE(local_features(landmarks(), 1).curves.empty());  // the networks saw nothing
}

TEST(NetworkFeatures, TellHowFarAnEyeIsOpen) {
    Seen seen;
    seen.eyes[1].contour.col(1) =
        (100 + .5 * (seen.eyes[1].contour.col(1).array() - 100)).matrix();  // half shut
    const Eigen::Vector2d openings = eye_openings(network_features(seen.mesh, seen.eyes));
    EXPECT_NEAR(openings[0], 7.5 / 18, 1e-9);  // means of the arches over what is left of their length
    EXPECT_NEAR(openings[1], 3.75 / 18, 1e-9);
    EXPECT_TRUE(eye_openings(landmarks()).array().isNaN().all());
}

TEST(NetworkFeatures, RefusePointsOfSomethingElse) {
    Seen seen;
    seen.mesh.places.conservativeResize(400, 2);
    EXPECT_THROW(network_features(seen.mesh, seen.eyes), InvalidInput);
}

}  // namespace
}  // namespace mimetic
