// SPDX-License-Identifier: GPL-3.0-or-later
#include "likeness.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

// Shares of the face's height: patches as large as an eye have some twenty independent parts after the blur,
// so that chance alone reaches kAlike in one of a hundred.
constexpr double kPatch = 21 / 200.;
constexpr double kBlur = 1.5 / 200;  // forgives what the model cannot follow, a pixel or two
constexpr float kBare = 100;         // normalised grey squared that noise alone reaches

}  // namespace

Likeness::Likeness(double face_height)
    : patch_(2 * static_cast<int>(std::lround(kPatch * face_height / 2 - .5)) + 1),
      blur_(kBlur * face_height) {}

double Likeness::compare(const cv::Mat1f& reference, const cv::Mat1f& present, const cv::Mat1f& weights) {
    cv::GaussianBlur(reference, reference_, {0, 0}, blur_);
    cv::GaussianBlur(present, present_, {0, 0}, blur_);
    const auto patch_mean = [this](const cv::Mat1f& a, const cv::Mat1f& b, cv::Mat1f& out) {
        cv::multiply(a, b, product_);
        cv::boxFilter(product_, out, CV_32F, {patch_, patch_}, {-1, -1}, true, cv::BORDER_CONSTANT);
    };
    patch_mean(reference_, present_, correlations_);
    patch_mean(reference_, reference_, own_);
    patch_mean(present_, present_, other_);
    double in_sight = 0, alike = 0;
    for (int y = 0; y < weights.rows; ++y) {
        for (int x = 0; x < weights.cols; ++x) {
            correlations_(y, x) /= std::sqrt((own_(y, x) + kBare) * (other_(y, x) + kBare));
            const double share = weights(y, x) * own_(y, x) / (own_(y, x) + kBare);
            in_sight += share;
            alike += correlations_(y, x) > kAlike ? share : 0;
        }
    }
    return in_sight > 0 ? alike / in_sight : 0;
}

}  // namespace mimetic
