// SPDX-License-Identifier: GPL-3.0-or-later
#include "likeness.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

// Shares of the face's height: patches as large as an eye have some twenty independent parts after the blur,
// so that chance alone reaches kAlike in one of a hundred.
constexpr double kPatch = 21 / 200.;
constexpr double kBlur = 1.5 / 200;  // tolerates errors of the model, a pixel or two
constexpr float kBare = 100;         // normalised grey squared that noise alone reaches

// Detail: what lies between two blurs, in pixels, as it is the textures' resolution that limits it; in a
// texture in which the face has more than so many pixels it is the footage's, and they are shares of the
// face.
constexpr double kDetailHeight = 200;
constexpr int kDetailPatch = 15;
constexpr double kFinest = .7;
constexpr double kBroadest = 2.5;
constexpr float kBareDetail = 30;

/// Mean products to correlations, given the mean squares of both. bare: mean square that noise alone reaches.
void normalise(cv::Mat1f& products, const cv::Mat1f& squares, const cv::Mat1f& other_squares, float bare) {
    for (int y = 0; y < products.rows; ++y) {
        for (int x = 0; x < products.cols; ++x) {
            products(y, x) /= std::sqrt((squares(y, x) + bare) * (other_squares(y, x) + bare));
        }
    }
}

}  // namespace

int odd(double pixels) { return 2 * static_cast<int>(std::lround((pixels - 1) / 2)) + 1; }

Likeness::Likeness(double face_height)
    : face_height_(face_height),
      patch_(odd(kPatch * face_height)),
      blur_(kBlur * face_height),
      detail_scale_(std::max(1., face_height / kDetailHeight)) {}

void Likeness::mean_products(const cv::Mat1f& a, const cv::Mat1f& b, int patch, cv::Mat1f& means) {
    cv::multiply(a, b, product_);
    cv::boxFilter(product_, means, CV_32F, {patch, patch}, {-1, -1}, true, cv::BORDER_CONSTANT);
}

void Likeness::filter(const cv::Mat1f& texture, FilteredTexture& filtered) {
    filtered.face_height = face_height_;
    cv::GaussianBlur(texture, filtered.coarse, {0, 0}, blur_);
    mean_products(filtered.coarse, filtered.coarse, patch_, filtered.coarse_squares);
    cv::GaussianBlur(texture, filtered.detail, {0, 0}, kFinest * detail_scale_);
    cv::GaussianBlur(filtered.detail, broad_, {0, 0}, kBroadest * detail_scale_);
    cv::subtract(filtered.detail, broad_, filtered.detail);
    mean_products(filtered.detail, filtered.detail, odd(kDetailPatch * detail_scale_),
                  filtered.detail_squares);
}

Look Likeness::compare(const ReferenceTexture& reference, const cv::Mat1f& present,
                       const cv::Mat1f& weights) {
    if (!reference.filtered_ || reference.filtered_->face_height != face_height_) {
        filter(reference.values(), reference.filtered_.emplace());
    }
    const FilteredTexture& own = *reference.filtered_;
    filter(present, present_);
    mean_products(own.coarse, present_.coarse, patch_, correlations_);
    normalise(correlations_, own.coarse_squares, present_.coarse_squares, kBare);
    mean_products(own.detail, present_.detail, odd(kDetailPatch * detail_scale_), detail_correlations_);
    normalise(detail_correlations_, own.detail_squares, present_.detail_squares, kBareDetail);
    double in_sight = 0, alike = 0, detailed = 0, same = 0;
    for (int y = 0; y < weights.rows; ++y) {
        for (int x = 0; x < weights.cols; ++x) {
            const double coarse = own.coarse_squares(y, x), fine = own.detail_squares(y, x);
            const double share = weights(y, x) * coarse / (coarse + kBare);
            in_sight += share;
            if (correlations_(y, x) > kAlike) {
                const double fine_share = weights(y, x) * fine / (fine + kBareDetail);
                alike += share;
                detailed += fine_share;
                same += fine_share * detail_correlations_(y, x);
            }
        }
    }
    return {in_sight > 0 ? alike / in_sight : 0, detailed > 0 ? same / detailed : 0};
}

}  // namespace mimetic
