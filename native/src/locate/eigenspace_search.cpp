// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/error.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "locate/likelihood.hpp"

namespace mimetic {
namespace {

constexpr double kLeastDeviation = 2;  // grey levels: plain walls are no faces

void need(bool holds, const std::string& what) {
    if (!holds) throw InvalidInput("search of eigenspaces: " + what);
}

cv::Mat1f gray_of(GrayView image) {
    const cv::Mat bytes(image.rows, image.cols, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    cv::Mat1f values;
    bytes.convertTo(values, CV_32F);
    return values;
}

/// The image turned so that what leans by `roll` stands upright.
cv::Mat1f upright(const cv::Mat1f& image, double roll, cv::Matx23d& image_from_upright) {
    const cv::Point2f middle(0.5f * static_cast<float>(image.cols - 1),
                             0.5f * static_cast<float>(image.rows - 1));
    const cv::Matx23d upright_from_image(cv::getRotationMatrix2D(middle, roll * 180 / std::numbers::pi, 1));
    cv::invertAffineTransform(upright_from_image, image_from_upright);
    if (roll == 0) return image;
    cv::Mat1f turned;
    cv::warpAffine(image, turned, upright_from_image, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return turned;
}

void search_scale(const std::vector<Eigenspace>& views, const cv::Mat1f& image, double width, int count,
                  std::vector<SpaceMatch>& found) {
    const double scale = views[0].width / width;
    const cv::Size size(static_cast<int>(std::lround(image.cols * scale)),
                        static_cast<int>(std::lround(image.rows * scale)));
    if (size.width < views[0].width || size.height < views[0].height) return;
    cv::Mat1f small;
    cv::resize(image, small, size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    const Eigen::Array2d shrink(static_cast<double>(size.width) / image.cols,
                                static_cast<double>(size.height) / image.rows);
    const Eigen::Array2d half(0.5 * views[0].width, 0.5 * views[0].height);
    for (std::size_t view = 0; view < views.size(); ++view) {
        const cv::Mat1f map = locate::likelihoods(views[view], small, kLeastDeviation);
        for (const auto& summit : locate::summits(map, 2 * count, 0.5 * views[0].width)) {
            SpaceMatch match;
            match.center = (summit.head<2>().array() + half) / shrink - 0.5;
            match.width = views[0].width / shrink.x();
            match.view = static_cast<int>(view);
            match.log_likelihood = summit.z();
            found.push_back(match);
        }
    }
}

}  // namespace

void SpaceSearchOptions::check() const {
    need(smallest >= 4, "smallest is " + std::to_string(smallest) + "; at least 4 pixels are needed");
    need(largest > 0 && largest <= 1,
         "largest is " + std::to_string(largest) + "; it is a part of the image's shorter side, to 1");
    need(steps_per_octave >= 1 && steps_per_octave <= 32, "steps_per_octave must be 1 to 32");
    need(largest_roll >= 0 && largest_roll <= 1.6, "largest_roll must be 0 to 1.6 radians");
    need(num_rolls >= 1 && num_rolls <= 31 && num_rolls % 2 == 1, "num_rolls must be odd, 1 to 31");
    need(num_matches >= 1 && num_matches <= 1000, "num_matches must be 1 to 1000");
    need(!std::isnan(least_likelihood), "least_likelihood is no number");
}

std::vector<SpaceMatch> search_spaces(const std::vector<Eigenspace>& views, GrayView image,
                                      const SpaceSearchOptions& options) {
    options.check();
    check_image_size(image.rows, image.cols, "image");
    need(!views.empty(), "there is no space to search for");
    for (const auto& view : views) {
        view.check();
        need(view.width == views[0].width && view.height == views[0].height,
             "all views need patches of one size");
    }
    const cv::Mat1f gray = gray_of(image);
    const double largest = options.largest * std::min(image.rows, image.cols);
    std::vector<SpaceMatch> found;
    for (int i = 0; i < options.num_rolls; ++i) {
        const int half = options.num_rolls / 2;
        const double roll = half == 0 ? 0 : options.largest_roll * (i - half) / half;
        cv::Matx23d image_from_upright;
        const cv::Mat1f turned = upright(gray, roll, image_from_upright);
        std::vector<SpaceMatch> here;
        double width = options.smallest;
        for (int k = 0; width <= largest;
             width = options.smallest * std::exp2(static_cast<double>(++k) / options.steps_per_octave))
            search_scale(views, turned, width, options.num_matches, here);
        for (auto& match : here) {
            const cv::Vec2d at = image_from_upright * cv::Vec3d(match.center.x(), match.center.y(), 1);
            match.center << at[0], at[1];
            match.roll = roll;
            found.push_back(match);
        }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.log_likelihood > b.log_likelihood; });
    std::vector<SpaceMatch> best;
    for (const auto& match : found) {
        if (static_cast<int>(best.size()) == options.num_matches) break;
        if (match.log_likelihood < options.least_likelihood) break;
        const auto overlaps = [&](const SpaceMatch& other) {
            return (other.center - match.center).norm() < 0.5 * std::max(other.width, match.width);
        };
        if (std::none_of(best.begin(), best.end(), overlaps)) best.push_back(match);
    }
    return best;
}

}  // namespace mimetic
