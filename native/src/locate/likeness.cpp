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

// Detail: what lies between two blurs, in pixels, as it is the textures' resolution that limits it
constexpr int kDetailPatch = 15;
constexpr double kFinest = .7;
constexpr double kBroadest = 2.5;
constexpr float kBareDetail = 30;

}  // namespace

void Likeness::Patches::compare(const cv::Mat1f& reference, const cv::Mat1f& present, int size, float bare) {
    const auto mean_product = [&](const cv::Mat1f& a, const cv::Mat1f& b, cv::Mat1f& out) {
        cv::multiply(a, b, product);
        cv::boxFilter(product, out, CV_32F, {size, size}, {-1, -1}, true, cv::BORDER_CONSTANT);
    };
    mean_product(reference, present, correlations);
    mean_product(reference, reference, own);
    mean_product(present, present, other);
    for (int y = 0; y < own.rows; ++y) {
        for (int x = 0; x < own.cols; ++x) {
            correlations(y, x) /= std::sqrt((own(y, x) + bare) * (other(y, x) + bare));
        }
    }
}

Likeness::Likeness(double face_height)
    : patch_(2 * static_cast<int>(std::lround(kPatch * face_height / 2 - .5)) + 1),
      blur_(kBlur * face_height) {}

Look Likeness::compare(const cv::Mat1f& reference, const cv::Mat1f& present, const cv::Mat1f& weights) {
    cv::GaussianBlur(reference, reference_, {0, 0}, blur_);
    cv::GaussianBlur(present, present_, {0, 0}, blur_);
    patches_.compare(reference_, present_, patch_, kBare);
    const auto take_detail = [this](const cv::Mat1f& texture, cv::Mat1f& detail) {
        cv::GaussianBlur(texture, detail, {0, 0}, kFinest);
        cv::GaussianBlur(detail, broad_, {0, 0}, kBroadest);
        cv::subtract(detail, broad_, detail);
    };
    take_detail(reference, reference_);
    take_detail(present, present_);
    details_.compare(reference_, present_, kDetailPatch, kBareDetail);
    double in_sight = 0, alike = 0, detailed = 0, same = 0;
    for (int y = 0; y < weights.rows; ++y) {
        for (int x = 0; x < weights.cols; ++x) {
            const float own = patches_.own(y, x), fine = details_.own(y, x);
            const double share = weights(y, x) * own / (own + kBare);
            in_sight += share;
            if (patches_.correlations(y, x) > kAlike) {
                const double fine_share = weights(y, x) * fine / (fine + kBareDetail);
                alike += share;
                detailed += fine_share;
                same += fine_share * details_.correlations(y, x);
            }
        }
    }
    return {in_sight > 0 ? alike / in_sight : 0, detailed > 0 ? same / detailed : 0};
}

}  // namespace mimetic
