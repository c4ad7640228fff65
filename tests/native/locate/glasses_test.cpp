// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/locate/glasses.hpp>
#include <mimetic/shared/error.hpp>
#include <vector>

namespace mimetic {
namespace {

constexpr int kSkin = 170;
const Camera kCamera{900, 900, 159.5, 119.5, 320, 240};

Points eyes() {
    Points centres(2, 3);
    centres << .032, .03, .05, -.032, .03, .05;
    return centres;
}

/// The eyes look into the camera, which is 60 cm before them.
Eigen::Isometry3d pose() {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    camera_from_head.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    camera_from_head.translation() = Eigen::Vector3d(0, .03, .65);
    return camera_from_head;
}

/// Grey skin with lines of a grey level along curves, `half_width` metres to each side, softened at the edges
/// over `soft` metres; a picture as it is at the eyes' distance.
class Picture {
public:
    Picture() : pixels_(std::size_t{3} * kCamera.width * kCamera.height, kSkin) {}

    void draw(const Points& curve, double level, double half_width, double soft = .5e-3) {
        std::vector<double> nearest(pixels_.size() / 3, 1e9);  // metres
        for (Eigen::Index k = 0; k < curve.rows(); ++k) {
            const Eigen::Vector3d point = pose() * curve.row(k).transpose();
            const Eigen::Vector2d at = kCamera.project(point);
            const double metre = kCamera.fx / point.z();
            const int reach = static_cast<int>((half_width + soft) * metre) + 2;
            const int middle_x = static_cast<int>(at.x()), middle_y = static_cast<int>(at.y());
            for (int y = middle_y - reach; y <= middle_y + reach; ++y) {
                for (int x = middle_x - reach; x <= middle_x + reach; ++x) {
                    double& known = nearest[static_cast<std::size_t>(y * kCamera.width + x)];
                    known = std::min(known, (at - Eigen::Vector2d(x, y)).norm() / metre);
                }
            }
        }
        for (std::size_t i = 0; i < pixels_.size(); ++i) {
            const double share = std::clamp((half_width - nearest[i / 3]) / soft + .5, 0., 1.);
            pixels_[i] = static_cast<std::uint8_t>(std::lround(pixels_[i] + share * (level - pixels_[i])));
        }
    }

    ColorView view() const { return {pixels_.data(), kCamera.height, kCamera.width, 3 * kCamera.width}; }

private:
    std::vector<std::uint8_t> pixels_;
};

/// A lens's outline before an eye, angles in degrees from straight aside, down first.
Points outline(int eye, double across, double down, double first = 0, double last = 360) {
    Points curve(181, 3);
    for (int k = 0; k < 181; ++k) {
        const double angle = (first + (last - first) * k / 180) * M_PI / 180;
        const double side = eye == 0 ? 1 : -1;
        curve.row(k) = eyes().row(eye) +
                       Eigen::RowVector3d(side * across * std::cos(angle), -down * std::sin(angle), .02);
    }
    return curve;
}

Points bridge() {
    Points curve(61, 3);
    for (int k = 0; k < 61; ++k) {
        curve.row(k) << .012 * (k / 30. - 1), .032, .072;
    }
    return curve;
}

void wear(Picture& picture, double across, double down, double level, double half_width) {
    for (const int eye : {0, 1}) {
        picture.draw(outline(eye, across, down), level, half_width);
    }
    picture.draw(bridge(), level, half_width);
}

/// How far off the lower half of a drawn outline a point is, metres in the picture.
double distance(const Eigen::RowVector3d& point, const Points& drawn) {
    double nearest = 1e9;
    const Eigen::Vector3d seen = pose() * point.transpose();
    for (Eigen::Index k = 0; k < drawn.rows(); ++k) {
        const Eigen::Vector3d other = pose() * drawn.row(k).transpose();
        nearest = std::min(nearest, (kCamera.project(seen) - kCamera.project(other)).norm());
    }
    return nearest * seen.z() / kCamera.fx;
}

TEST(GlassesRims, AreFoundWhereTheyAre) {
    struct Worn {
        double across, down, level, half_width;
    };
    for (const Worn& worn : {Worn{.023, .02, 30, 1.2e-3}, Worn{.026, .019, 60, .6e-3},
                             Worn{.022, .022, 250, .8e-3}, Worn{.024, .02, 25, 2.5e-3}}) {
        Picture picture;
        wear(picture, worn.across, worn.down, worn.level, worn.half_width);
        const auto rims = glasses_rims(picture.view(), kCamera, pose(), eyes());
        ASSERT_EQ(rims.size(), 3U) << worn.level;
        for (const int eye : {0, 1}) {
            const Points drawn = outline(eye, worn.across, worn.down);
            const Points& rim = rims[static_cast<std::size_t>(eye)];
            double lowest = 0;
            for (Eigen::Index k = 0; k < rim.rows(); ++k) {
                EXPECT_LT(distance(rim.row(k), drawn), worn.half_width + 1.5e-3) << eye << " " << k;
                lowest = std::min(lowest, rim(k, 1) - eyes()(eye, 1));
            }
            EXPECT_NEAR(lowest, -worn.down, worn.half_width + 2e-3);
        }
        for (Eigen::Index k = 0; k < rims[2].rows(); ++k) {
            EXPECT_LT(distance(rims[2].row(k), bridge()), worn.half_width + 2e-3);
        }
    }
}

TEST(GlassesRims, AreNoneOnABareFace) {
    Picture bare;
    EXPECT_TRUE(glasses_rims(bare.view(), kCamera, pose(), eyes()).empty());
    // Folds below the eyes, soft and hard; brows that meet
    Picture bags, lines;
    for (const int eye : {0, 1}) {
        bags.draw(outline(eye, .024, .02, 20, 160), 120, 3e-3, 5e-3);
        lines.draw(outline(eye, .024, .02, 20, 160), 60, .8e-3);
        lines.draw(outline(eye, .026, .022, 210, 330), 40, 3e-3);
    }
    bags.draw(bridge(), 165, 3e-3, 5e-3);
    EXPECT_TRUE(glasses_rims(bags.view(), kCamera, pose(), eyes()).empty());
    EXPECT_TRUE(glasses_rims(lines.view(), kCamera, pose(), eyes()).empty());
    // One lens, as a monocle or a strand of hair
    Picture one;
    one.draw(outline(0, .023, .02), 30, 1.2e-3);
    one.draw(bridge(), 30, 1.2e-3);
    EXPECT_TRUE(glasses_rims(one.view(), kCamera, pose(), eyes()).empty());
}

TEST(GlassesRims, RefuseWhatDoesNotFit) {
    const Picture picture;
    Camera other = kCamera;
    other.width = 300;
    EXPECT_THROW(glasses_rims(picture.view(), other, pose(), eyes()), InvalidInput);
    EXPECT_THROW(glasses_rims(picture.view(), kCamera, pose(), Points::Zero(3, 3)), InvalidInput);
    // Behind the camera, or far beside the picture, no rim is seen
    Eigen::Isometry3d beside = pose();
    beside.translation().x() = 3;
    EXPECT_TRUE(glasses_rims(picture.view(), kCamera, beside, eyes()).empty());
    beside.translation() = Eigen::Vector3d(0, 0, -1);
    EXPECT_TRUE(glasses_rims(picture.view(), kCamera, beside, eyes()).empty());
}

}  // namespace
}  // namespace mimetic
