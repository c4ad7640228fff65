// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <mimetic/puppet/front_view.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

#include "../head/head_scene.hpp"

namespace mimetic {
namespace {

double rms(const GrayPicture& a, const GrayPicture& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        sum += std::pow(double(a.pixels[i]) - b.pixels[i], 2);
    }
    return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

TEST(FrontView, ShowsATurnedHeadAsFromTheFront) {
    const test::HeadScene scene(false);
    FrontViewOptions options;
    options.left = -.03;
    options.right = .03;
    options.bottom = -.03;
    options.top = .03;
    options.pixel = 1.5e-3;
    const FrontView view(scene.camera, scene.vertices, scene.faces, options);
    const Eigen::Isometry3d front = test::HeadScene::motion(0);
    Eigen::Isometry3d turned = front;
    turned.linear() = rotation_from_vector({0, .25, .15}) * front.linear();
    turned.translation() += Eigen::Vector3d(.02, -.01, .05);
    const auto at_front = scene.render(front), at_turn = scene.render(turned);
    const GrayPicture reference = view.picture(scene.view(at_front), front);
    EXPECT_EQ(reference.rows, 40);
    EXPECT_EQ(reference.cols, 40);
    const double stabilised = rms(reference, view.picture(scene.view(at_turn), turned));
    const double unstabilised = rms(reference, view.picture(scene.view(at_turn), front));
    EXPECT_LT(stabilised, .25 * unstabilised);
    EXPECT_LT(stabilised, 6);
}

TEST(FrontView, NamesThePixelOfAPlaceAndRefusesWhatShowsNothing) {
    const test::HeadScene scene(false);
    const FrontView view(scene.camera, scene.vertices, scene.faces);
    EXPECT_TRUE(view.pixel_of(0, 0).isApprox(Eigen::Vector2d(79.5, 89.5)));
    EXPECT_TRUE(view.pixel_of(.01, .02).isApprox(Eigen::Vector2d(89.5, 69.5)));
    FrontViewOptions aside;
    aside.left = .2;
    aside.right = .3;
    EXPECT_THROW(FrontView(scene.camera, scene.vertices, scene.faces, aside), InvalidInput);
    aside.pixel = 1;
    EXPECT_THROW(FrontView(scene.camera, scene.vertices, scene.faces, aside), InvalidInput);
    Eigen::Isometry3d unknown = test::HeadScene::motion(0);
    unknown.translation().x() = std::numeric_limits<double>::quiet_NaN();
    const auto image = scene.render(test::HeadScene::motion(0));
    EXPECT_THROW(view.picture(scene.view(image), unknown), InvalidInput);
}

}  // namespace
}  // namespace mimetic
