// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/well_lit.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "locate/clear_view.hpp"
#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

constexpr double kCropPerBox = 1.6;  // sides of a face's crop, in widths of the box that a finder gives
// The light is smooth but for the edges of shadows, which are darker than a face's own marks. Chosen on
// frames of five clips of real people, of which one half was darkened to a fifth and a tenth
constexpr double kRadius = 0.11;  // of the filter, in sides of a face's crop
constexpr double kEdge = 0.5;     // variance of the logarithm that is half an edge
constexpr int kCoarseRadius = 8;  // pixels that the filter's radius is shrunk to
constexpr float kDark = 0.012F;   // of white, added to every pixel: noise in black is no light
constexpr double kMostGain = 16;  // more only raises noise
constexpr double kEven = 1.4;     // ratio of the light on both halves from which it is evened; 1.3 is usual
constexpr double kUneven = 2;     // from which it is evened altogether
constexpr double kReach = 0.75;   // of a crop's side: its corners, however it is turned
constexpr double kBright = 0.8;   // quantile of the light on a face that is taken for full light
// Light on a face, of white, below which raising begins and is full, and what it is raised to
constexpr double kDim = 0.14, kTooDim = 0.08, kWell = 0.35;
constexpr double kBrightOfAll = 0.9;  // of the light in a whole picture
// From its middle, in sides of a crop, what is looked at of a face
constexpr double kAside = .22, kTop = -.125, kBottom = .25;
constexpr double kFaceOfPicture = 0.73;  // side of a crop that looks for faces, in the picture's shorter side

/// The logarithm of a light, of white, as `Light` has it.
double log_of(double light) { return std::log(light + kDark); }

cv::Mat1f logarithm_of(const cv::Mat1b& gray) {
    cv::Mat1f table(1, 256);
    for (int i = 0; i < 256; ++i) table(i) = std::log(static_cast<float>(i) / 255 + kDark);
    cv::Mat1f result;
    cv::LUT(gray, table, result);
    return result;
}

/// The logarithm of the light in a picture, a guided filter of the picture by itself [He, Sun and Tang 2013],
/// whose factors are found on a small one.
class Light {
public:
    /// radius: of the filter, pixels
    Light(const cv::Mat& color, double radius) {
        cv::cvtColor(color, gray_, cv::COLOR_RGB2GRAY);
        scale_ = std::min(1., kCoarseRadius / radius);
        const auto coarse_side = [this](int side) {
            return std::max(1, static_cast<int>(std::lround(side * scale_)));
        };
        cv::Mat1b coarse_gray;
        cv::resize(gray_, coarse_gray, {coarse_side(gray_.cols), coarse_side(gray_.rows)}, 0, 0,
                   cv::INTER_AREA);
        const cv::Mat1f coarse = logarithm_of(coarse_gray);
        const int side = 2 * std::max(1, static_cast<int>(std::lround(radius * scale_))) + 1;
        const auto mean = [side](const cv::Mat& values) {
            cv::Mat1f result;
            cv::boxFilter(values, result, CV_32F, {side, side}, {-1, -1}, true, cv::BORDER_REFLECT);
            return result;
        };
        const cv::Mat1f middle = mean(coarse), variance = mean(coarse.mul(coarse)) - middle.mul(middle);
        cv::Mat1f slope;
        cv::divide(variance, variance + kEdge, slope);
        offset_ = mean(middle - slope.mul(middle));
        slope_ = mean(slope);
        coarse_ = slope_.mul(coarse) + offset_;
    }

    /// Of the picture made small.
    const cv::Mat1f& coarse() const { return coarse_; }

    /// At a pixel, from the picture made small; none beside it.
    std::optional<float> at(const Eigen::Vector2d& pixel) const {
        const cv::Point place(static_cast<int>(std::floor((pixel.x() + .5) * scale_)),
                              static_cast<int>(std::floor((pixel.y() + .5) * scale_)));
        if (!cv::Rect({}, coarse_.size()).contains(place)) return {};
        return coarse_(place);
    }

    cv::Mat1f fine() const {
        cv::Mat1f slope, offset;
        cv::resize(slope_, slope, gray_.size(), 0, 0, cv::INTER_LINEAR);
        cv::resize(offset_, offset, gray_.size(), 0, 0, cv::INTER_LINEAR);
        return slope.mul(logarithm_of(gray_)) + offset;
    }

private:
    double scale_ = 1;
    cv::Mat1b gray_;
    cv::Mat1f slope_, offset_, coarse_;
};

double quantile(std::vector<float> values, double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, values.begin() + at);
    return values[static_cast<std::size_t>(at)];
}

/// The part of the picture about a crop; it has no pixels where the crop lies beside the picture.
cv::Rect part_about(ColorView image, const FeatureCrop& crop) {
    crop.check();
    const double reach = kReach * crop.side;
    const cv::Point first(static_cast<int>(std::floor(crop.center.x() - reach)),
                          static_cast<int>(std::floor(crop.center.y() - reach)));
    const int side = static_cast<int>(std::ceil(2 * reach)) + 1;
    return cv::Rect(first, cv::Size(side, side)) & cv::Rect(0, 0, image.cols, image.rows);
}

/// The light on the halves of a face, as logarithms, from its forehead to its mouth.
struct Halves {
    std::vector<float> left, right;

    bool are_seen() const { return left.size() >= 8 && right.size() >= 8; }
    double log_ratio() const { return std::abs(quantile(left, .5) - quantile(right, .5)); }
    double bright() const {
        std::vector<float> all = left;
        all.insert(all.end(), right.begin(), right.end());
        return quantile(std::move(all), kBright);
    }
};

/// corner: pixels, of the part of the picture whose light it is
Halves halves_of(const Light& light, const FeatureCrop& crop, const cv::Point& corner) {
    constexpr int kAcross = 12, kDown = 24;
    constexpr double kFirst = .05;  // in sides of the crop
    const Eigen::Vector2d across(std::cos(crop.roll), std::sin(crop.roll)), down(-across.y(), across.x());
    Halves halves;
    for (int row = 0; row < kDown; ++row) {
        const double y = kTop + (kBottom - kTop) * row / (kDown - 1);
        for (int column = 0; column < kAcross; ++column) {
            const double x = kFirst + (kAside - kFirst) * column / (kAcross - 1);
            for (const double side : {-1., 1.}) {
                const Eigen::Vector2d place = crop.center + crop.side * (side * x * across + y * down);
                if (const auto lit = light.at(place - Eigen::Vector2d(corner.x, corner.y))) {
                    (side < 0 ? halves.left : halves.right).push_back(*lit);
                }
            }
        }
    }
    return halves;
}

/// From the forehead to the mouth of a face, in the part of the picture that begins at a corner.
cv::Rect middle_of(const FeatureCrop& crop, const cv::Rect& part) {
    const Eigen::Vector2d first = crop.center + crop.side * Eigen::Vector2d(-kAside, kTop);
    const Eigen::Vector2d size = crop.side * Eigen::Vector2d(2 * kAside, kBottom - kTop);
    return cv::Rect(cv::Rect2d(first.x() - part.x, first.y() - part.y, size.x(), size.y())) &
           cv::Rect({}, part.size());
}

/// Raises what has less light than `bright`, and all by `brighter`, in place; logarithms. share: of what is
/// less that is made up, 0 to 1
void raise(const Light& light, double bright, double share, double brighter, cv::Mat& color) {
    cv::Mat1f gain = bright - light.fine();
    gain = cv::max(gain, 0) * share + brighter;
    gain = cv::min(gain, std::log(kMostGain));
    cv::exp(gain, gain);
    cv::Mat3f raised;
    color.convertTo(raised, CV_32F);
    cv::Mat3f gains;
    cv::merge(std::vector<cv::Mat>(3, gain), gains);
    cv::Mat(raised.mul(gains)).convertTo(color, CV_8U);
}

ColorImage copy_of(ColorView image) {
    ColorImage copy{image.rows, image.cols, {}};
    copy.pixels.resize(3 * static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.cols));
    as_matrix(image).copyTo(cv::Mat(copy.rows, copy.cols, CV_8UC3, copy.pixels.data()));
    return copy;
}

}  // namespace

FeatureCrop crop_about(const FaceFeatures& face) {
    FeatureCrop crop;
    crop.center << face.box(0) + face.box(2) / 2, face.box(1) + face.box(3) / 2;
    crop.side = kCropPerBox * face.box(2);
    crop.roll = face.roll;
    return crop;
}

std::optional<ColorImage> well_lit(ColorView image, const FeatureCrop& face) {
    check_image_size(image.rows, image.cols, "image");
    const cv::Rect part = part_about(image, face);
    if (part.empty()) return {};
    const cv::Mat as_filmed = as_matrix(image)(part);
    const cv::Mat cleared = locate::clear_view(as_filmed, middle_of(face, part));
    const Light light(cleared, kRadius * face.side);
    const Halves halves = halves_of(light, face, part.tl());
    if (!halves.are_seen()) return {};
    const double bright = halves.bright();
    const double uneven = (halves.log_ratio() - std::log(kEven)) / std::log(kUneven / kEven);
    const double dim = (log_of(kDim) - bright) / (log_of(kDim) - log_of(kTooDim));
    if (std::max(uneven, dim) <= 0 && cleared.data == as_filmed.data) return {};
    const double brighter = std::clamp(dim, 0., 1.) * std::max(0., log_of(kWell) - bright);
    ColorImage raised = copy_of(image);
    cv::Mat whole(raised.rows, raised.cols, CV_8UC3, raised.pixels.data());
    cv::Mat about = whole(part);
    cleared.copyTo(about);
    raise(light, bright, std::clamp(uneven, 0., 1.), brighter, about);
    return raised;
}

ColorImage with_raised_shadows(ColorView image) {
    check_image_size(image.rows, image.cols, "image");
    ColorImage raised = copy_of(image);
    cv::Mat whole(raised.rows, raised.cols, CV_8UC3, raised.pixels.data());
    const cv::Mat cleared = locate::clear_view(whole, cv::Rect({}, whole.size()));
    if (cleared.data != whole.data) cleared.copyTo(whole);
    const Light light(whole, kRadius * kFaceOfPicture * std::min(image.rows, image.cols));
    const std::vector<float> all(light.coarse().begin(), light.coarse().end());
    const double bright = quantile(all, kBrightOfAll);
    raise(light, bright, 1, std::max(0., log_of(kWell) - bright), whole);
    return raised;
}

}  // namespace mimetic
