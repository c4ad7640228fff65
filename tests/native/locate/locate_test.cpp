// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <mimetic/locate/locate.hpp>
#include <mimetic/shared/error.hpp>
#include <vector>

#include "locate/widened.hpp"

namespace mimetic {
namespace {

/// A level face of soft ellipses on plain skin: eyes, nostrils, mouth line and an outline at known places.
class DrawnFace {
public:
    static constexpr int kWidth = 200;
    static constexpr int kHeight = 240;
    static constexpr double kIpd = 50;
    const Eigen::Vector2d mid_eyes{98.3, 95.6};

    DrawnFace() : pixels_(kWidth * kHeight * 3) {
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) paint(x, y);
        }
    }

    ColorView view() const { return {pixels_.data(), kHeight, kWidth, kWidth * 3}; }
    Eigen::Vector2d at(double x, double y) const { return mid_eyes + kIpd * Eigen::Vector2d(x, y); }

private:
    /// 1 inside an ellipse to 0 outside, over a rim of 1.5 pixels
    double inside(double x, double y, const Eigen::Vector2d& center, double radius_x, double radius_y) const {
        const double distance = std::hypot((x - center.x()) / radius_x, (y - center.y()) / radius_y);
        return 1 / (1 + std::exp((distance - 1) * std::min(radius_x, radius_y) / 0.5));
    }

    void paint(int x, int y) {
        Eigen::Vector3d color(60, 90, 140);
        const auto blend = [&](double amount, const Eigen::Vector3d& other) {
            color += amount * (other - color);
        };
        blend(inside(x, y, at(0, 0.55), 1.1 * kIpd, 1.3 * kIpd), {205, 160, 135});
        for (const int side : {-1, 1}) {
            blend(inside(x, y, at(0.5 * side, 0), 0.24 * kIpd, 0.11 * kIpd), {235, 235, 235});
            blend(inside(x, y, at(0.5 * side, 0), 0.093 * kIpd, 0.093 * kIpd), {40, 35, 30});
            blend(inside(x, y, at(0.13 * side, 0.76), 0.06 * kIpd, 0.04 * kIpd), {70, 40, 35});
        }
        blend(inside(x, y, at(0, 1.16), 0.42 * kIpd, 0.15 * kIpd), {185, 95, 95});
        blend(inside(x, y, at(0, 1.16), 0.42 * kIpd, 0.03 * kIpd), {70, 30, 30});
        for (int channel = 0; channel < 3; ++channel) {
            pixels_[static_cast<std::size_t>((y * kWidth + x) * 3 + channel)] =
                static_cast<std::uint8_t>(std::lround(color(channel)));
        }
    }

    std::vector<std::uint8_t> pixels_;
};

FaceFeatures pupils_off_by(const DrawnFace& face, double shift) {
    FaceFeatures expected;
    expected.features.push_back({"pupil.R", face.at(-0.5, 0) + Eigen::Vector2d(shift, -shift), 1, 1});
    expected.features.push_back({"pupil.L", face.at(0.5, 0) + Eigen::Vector2d(-shift, shift), 1, 1});
    return expected;
}

TEST(MeasureFeatures, FindsWhatIsDrawnWithinThreeHundredthsOfThePupilDistance) {
    const DrawnFace face;
    const FaceFeatures found = measure_features(face.view(), pupils_off_by(face, 1.5), 0.15);
    const std::vector<std::pair<std::string, Eigen::Vector2d>> drawn = {
        {"pupil.R", face.at(-0.5, 0)},
        {"pupil.L", face.at(0.5, 0)},
        {"nostril.R", face.at(-0.13, 0.76)},
        {"nostril.L", face.at(0.13, 0.76)},
    };
    for (const auto& [name, place] : drawn) {
        const Feature* feature = found.find(name);
        ASSERT_NE(feature, nullptr) << name;
        EXPECT_LT((feature->position - place).norm(), 0.03 * DrawnFace::kIpd) << name;
        EXPECT_GT(feature->likelihood, 0.3) << name;
    }
    for (const auto& [name, side] : {std::pair{"mouth_corner.R", -1}, std::pair{"mouth_corner.L", 1}}) {
        EXPECT_LT((found.find(name)->position - face.at(0.42 * side, 1.16)).norm(), 0.08 * DrawnFace::kIpd)
            << name;
    }
}

TEST(MeasureFeatures, JawCurveLiesOnTheOutlineWithNormalsOutwards) {
    const DrawnFace face;
    const FaceFeatures found = measure_features(face.view(), pupils_off_by(face, 0), 0.2);
    const FeatureCurve* jaw = found.find_curve("jaw");
    ASSERT_NE(jaw, nullptr);
    const Eigen::Vector2d center = face.at(0, 0.55);
    double off = 0;
    for (int i = 0; i < jaw->points.rows(); ++i) {
        const Eigen::Vector2d ray = jaw->points.row(i).transpose() - center;
        off += std::abs(std::hypot(ray.x() / 1.1, ray.y() / 1.3) / DrawnFace::kIpd - 1) /
               static_cast<double>(jaw->points.rows());
        EXPECT_GT(ray.normalized().dot(jaw->normals.row(i)), 0.5);
    }
    EXPECT_LT(off, 0.03);
    const FaceFeatures lines =
        measure_features(face.view(), pupils_off_by(face, 0), 0.2, MeasuredParts::mouth_and_jaw);
    EXPECT_EQ(lines.find("pupil.R"), nullptr);
    EXPECT_EQ(lines.find_curve("jaw")->points, jaw->points);
}

TEST(MeasureFeatures, RefusesPupilsThatCoincide) {
    const DrawnFace face;
    FaceFeatures expected = pupils_off_by(face, 0);
    expected.features[0].position = expected.features[1].position;
    EXPECT_THROW(measure_features(face.view(), expected), InvalidInput);
}

TEST(MeasureFeatures, RefusesExpectationsThatAreNotFinite) {
    const DrawnFace face;
    FaceFeatures expected = pupils_off_by(face, 0);
    expected.features.push_back({"mouth_corner.L", {std::nan(""), 0}, 1, 1});
    EXPECT_THROW(measure_features(face.view(), expected), InvalidInput);
}

TEST(FaceLocator, NamesTheDetectorFileThatIsMissing) {
    try {
        FaceLocator("nowhere");
        FAIL() << "a missing file was accepted";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("nowhere/haarcascade_frontalface_alt2.xml"),
                  std::string::npos);
    }
}

TEST(Widened, IsNoLargerThanAPictureMayBe) {
    constexpr int kRows = 16;
    for (const int cols : {200, 14000, kLargestImage}) {
        const std::vector<std::uint8_t> pixels(std::size_t{3} * kRows * static_cast<std::size_t>(cols));
        const locate::Widened wide({pixels.data(), kRows, cols, 3 * cols});
        EXPECT_LE(wide.view().cols, kLargestImage) << cols;
        EXPECT_GE(wide.view().cols, cols) << cols;
        FaceFeatures face;
        face.box << 0, 0, 10, 10;
        const int margin = (wide.view().cols - cols) / 2;
        EXPECT_EQ(wide.in_picture(face).box(0), -margin) << cols;
    }
}

TEST(LocateOptions, NamesTheFieldAndItsLimit) {
    LocateOptions options;
    options.smallest_face = 0;
    EXPECT_THROW(options.check(), InvalidInput);
}

}  // namespace
}  // namespace mimetic
