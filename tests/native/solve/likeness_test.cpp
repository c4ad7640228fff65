// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/locate/likeness.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "../../../native/src/solve/reference_view.hpp"
#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::FaceScene;

cv::Mat1b grey_of(const FaceScene& scene, std::vector<std::uint8_t> image) {
    cv::Mat1b grey;
    const cv::Mat3b color(scene.camera.height, scene.camera.width,
                          reinterpret_cast<cv::Vec3b*>(image.data()));
    cv::extractChannel(color, grey, 0);
    return grey;
}

/// A reference texture, and the share of it that pictures of the same place show.
class LikenessTest : public testing::Test {
protected:
    LikenessTest()
        : surface(scene.surface, scene.motion),
          at{scene.camera_from_head, scene.rest()},
          view(surface, scene.camera, at, grey_of(scene, scene.render(scene.camera_from_head, scene.rest())),
               200, 4, 2) {
        projected.update(surface, scene.camera, at.camera_from_head, at.values);
        visible.assign(view.samples().size(), 1);
    }

    double share_alike(const cv::Mat1b& grey) { return share_alike(grey, likeness); }

    double share_alike(const cv::Mat1b& grey, Likeness& by) {
        PreparedFrame frame;
        frame.update(grey, view.scale());
        cv::Mat2f map;
        cv::Mat1f texture;
        view.stabilise(surface.triangles(), projected, frame, map, texture);
        return by.compare(view.texture(), texture, view.sample_weights(visible)).alike;
    }

    /// By textures in which the face has so many pixels.
    Look look_at(const cv::Mat1b& grey, int face_height) {
        const cv::Mat1b own = grey_of(scene, scene.render(at.camera_from_head, at.values));
        ReferenceView texture_of_its_size(surface, scene.camera, at, own, face_height, 4, 2);
        PreparedFrame frame;
        frame.update(grey, texture_of_its_size.scale());
        cv::Mat2f map;
        cv::Mat1f texture;
        texture_of_its_size.stabilise(surface.triangles(), projected, frame, map, texture);
        const std::vector<float> all(texture_of_its_size.samples().size(), 1);
        return Likeness(face_height)
            .compare(texture_of_its_size.texture(), texture, texture_of_its_size.sample_weights(all));
    }

    FaceScene scene;
    FaceSurface surface;
    FaceState at;
    ReferenceView view;
    ProjectedSurface projected;
    std::vector<float> visible;
    Likeness likeness{200};
};

TEST_F(LikenessTest, IsWholeForTheSameSkinInOtherLight) {
    EXPECT_GT(share_alike(grey_of(scene, scene.render(at.camera_from_head, at.values, 4, .7, 20, 9))), .95);
}

TEST_F(LikenessTest, IsNoneForAnotherSkinOfTheSameShape) {
    FaceScene other;
    other.person = .3;
    EXPECT_LT(share_alike(grey_of(other, other.render(at.camera_from_head, at.values))), .1);
}

TEST_F(LikenessTest, FallsByWhatIsCovered) {
    cv::Mat1b grey = grey_of(scene, scene.render(at.camera_from_head, at.values));
    grey.colRange(0, scene.camera.width / 2).setTo(90);
    EXPECT_NEAR(share_alike(grey), .5, .15);
}

TEST_F(LikenessTest, KeepsOfTheReferenceWhatOneOfItsSizeMade) {
    cv::Mat1b grey = grey_of(scene, scene.render(at.camera_from_head, at.values));
    grey.colRange(0, scene.camera.width / 2).setTo(90);
    Likeness larger{260};
    const double as_larger = share_alike(grey, larger);
    const double share = share_alike(grey, likeness);
    EXPECT_EQ(share_alike(grey, likeness), share);
    EXPECT_NE(as_larger, share);
    EXPECT_EQ(share_alike(grey, larger), as_larger);
}

TEST_F(LikenessTest, DetailIsOfTheFootageHoweverMuchATextureMagnifiesIt) {
    cv::Mat1b grey = grey_of(scene, scene.render(at.camera_from_head, at.values));
    cv::Mat1f noise(grey.size());
    cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0, 12);
    cv::add(grey, noise, grey, cv::noArray(), CV_8U);
    const double kept = look_at(grey, 200).detail;
    EXPECT_LT(kept, .9);
    EXPECT_NEAR(look_at(grey, 300).detail, kept, .05);
    EXPECT_NEAR(look_at(grey, 400).detail, kept, .05);
}

TEST_F(LikenessTest, IsTheSameByFinerTextures) {
    const cv::Mat1b grey = grey_of(scene, scene.render(at.camera_from_head, at.values));
    cv::Mat1b shifted;  // by some millimetres, as of a face whose shape is wrong
    cv::warpAffine(grey, shifted, cv::Matx23f(1, 0, 3, 0, 1, 3), grey.size());
    const double alike = look_at(shifted, 200).alike;
    EXPECT_GT(alike, .1);
    EXPECT_LT(alike, .9);
    EXPECT_NEAR(look_at(shifted, 300).alike, alike, .05);
    EXPECT_NEAR(look_at(shifted, 400).alike, alike, .05);
}

TEST_F(LikenessTest, IsNoneWhereNothingIsInSight) {
    visible.assign(visible.size(), 0);
    EXPECT_EQ(share_alike(grey_of(scene, scene.render(at.camera_from_head, at.values))), 0);
}

}  // namespace
}  // namespace mimetic
