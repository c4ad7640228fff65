// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/solve/seen_outline.hpp"

#include <gtest/gtest.h>

#include <mimetic/shared/error.hpp>

#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::FaceScene;

struct SeenOutline : testing::Test {
    FaceScene scene;
    FaceState turned{scene.camera_from_head, scene.rest()};

    SeenOutline() { turned.camera_from_head.rotate(Eigen::AngleAxisd(.6, Eigen::Vector3d::UnitY())); }

    SkinObservations look(const std::vector<std::uint8_t>& image, double size = 1) const {
        FaceMotion motion = scene.motion;
        motion.neutral *= size;
        return seen_outline(FaceSurface(scene.surface, motion), scene.camera, turned, scene.view(image));
    }

    /// Pixels by which the outline is seen outside of a surface of this size, and the s.d. of each.
    std::vector<std::pair<double, double>> outside(const SkinObservations& seen, double size = 1) const {
        std::vector<std::pair<double, double>> found;
        const Eigen::Vector2d middle = scene.camera.project(turned.camera_from_head.translation());
        for (Eigen::Index k = 0; k < seen.pixels.rows(); ++k) {
            Eigen::Vector3d place = Eigen::Vector3d::Zero();
            for (int corner = 0; corner < 3; ++corner) {
                place += seen.barycentric(k, corner) * size *
                         scene.motion.neutral.row(seen.vertices(k, corner)).transpose();
            }
            const Eigen::Vector2d expected = scene.camera.project(turned.camera_from_head * place);
            const Eigen::Vector2d apart = seen.pixels.row(k).transpose() - expected;
            const double side = apart.dot(expected - middle) < 0 ? -1 : 1;
            const double known = seen.information(k, 0) + seen.information(k, 3);
            found.emplace_back(side * apart.norm(), 1 / std::sqrt(known));
        }
        std::sort(found.begin(), found.end());
        return found;
    }
};

TEST_F(SeenOutline, LiesWhereTheFaceEnds) {
    // Overexposed before black, so that no pattern of the skin looks like its end
    const auto image = scene.render(turned.camera_from_head, scene.rest(), 2, 6, -360);
    const auto found = outside(look(image));
    ASSERT_GE(found.size(), 8U);
    EXPECT_NEAR(found[found.size() / 2].first, 0, .4);
    for (const auto& [offset, std] : found) {
        EXPECT_LT(std::abs(offset), 3 * std);
    }
}

TEST_F(SeenOutline, TellsHowMuchWiderAFaceIs) {
    const auto image = scene.render(turned.camera_from_head, scene.rest());
    constexpr double kSize = .96;  // the outline is some 70 pixels from the middle
    const auto found = outside(look(image, kSize), kSize);
    ASSERT_GE(found.size(), 8U);
    EXPECT_NEAR(found[found.size() / 2].first, 70 * (1 - kSize), 1);
}

TEST_F(SeenOutline, IsOfOneDirection) {
    const SkinObservations seen = look(scene.render(turned.camera_from_head, scene.rest()));
    ASSERT_GE(seen.pixels.rows(), 8);
    for (Eigen::Index k = 0; k < seen.pixels.rows(); ++k) {
        const auto& row = seen.information.row(k);
        EXPECT_NEAR(row[0] * row[3] - row[1] * row[2], 0, 1e-9);
        EXPECT_GT(row[0] + row[3], 0);
    }
}

TEST_F(SeenOutline, IsNotSeenBeforeAWallOfItsColour) {
    const std::vector<std::uint8_t> wall(std::size_t(3 * scene.camera.width * scene.camera.height), 130);
    EXPECT_EQ(look(wall).pixels.rows(), 0);
}

TEST_F(SeenOutline, IsOfWhatIsMeasured) {
    for (Eigen::Index v = 0; v < scene.surface.weights.size(); ++v) {
        scene.surface.weights[v] = std::abs(scene.motion.neutral(v, 0)) < .03 ? 1 : 0;
    }
    EXPECT_EQ(look(scene.render(turned.camera_from_head, scene.rest())).pixels.rows(), 0);
}

TEST_F(SeenOutline, IsNotSeenAgainstTheHeadItself) {
    const auto image = scene.render(turned.camera_from_head, scene.rest());
    const Eigen::Index count = scene.motion.neutral.rows();
    // Skin that is not measured, as a neck, goes on behind the whole face
    FaceMotion& motion = scene.motion;
    motion.neutral.conservativeResize(count + 4, Eigen::NoChange);
    motion.neutral.bottomRows<4>() << -.4, .4, -.1, -.4, -.4, -.1, .4, -.4, -.1, .4, .4, -.1;
    motion.modes.conservativeResize(Eigen::NoChange, 3 * (count + 4));
    motion.modes.rightCols<12>().setZero();
    TrackedSurface& surface = scene.surface;
    surface.stencils.resize(count + 4, count + 4);
    surface.stencils.setIdentity();
    surface.weights.conservativeResize(count + 4);
    surface.weights.tail<4>().setZero();
    surface.quads.conservativeResize(surface.quads.rows() + 1, Eigen::NoChange);
    const int first = static_cast<int>(count);
    surface.quads.bottomRows<1>() << first, first + 1, first + 2, first + 3;
    EXPECT_EQ(look(image).pixels.rows(), 0);
}

TEST_F(SeenOutline, NeedsAFrameOfTheCamerasSize) {
    const auto image = scene.render(scene.camera_from_head, scene.rest());
    const FaceTracker tracker(scene.camera, scene.surface, scene.motion, scene.view(image),
                              scene.camera_from_head);
    ColorView smaller = scene.view(image);
    smaller.rows -= 1;
    EXPECT_THROW(static_cast<void>(tracker.outline(smaller)), InvalidInput);
}

}  // namespace
}  // namespace mimetic
