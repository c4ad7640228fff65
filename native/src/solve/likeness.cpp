// SPDX-License-Identifier: GPL-3.0-or-later
#include "likeness.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

// Reference pixels, of a face 200 high: patches as large as an eye have some twenty independent parts after
// the blur, so that chance alone reaches kAlike in one of a hundred.
constexpr int kPatch = 21;
constexpr double kBlur = 1.5;  // forgives what the modes cannot follow, a pixel or two
constexpr float kBare = 100;   // normalised grey squared that noise alone reaches

void patch_mean(const cv::Mat1f& in, cv::Mat1f& out) {
    cv::boxFilter(in, out, CV_32F, {kPatch, kPatch}, {-1, -1}, true, cv::BORDER_CONSTANT);
}

}  // namespace

double Likeness::compare(const ReferenceView& view, const cv::Mat1f& texture,
                         const std::vector<float>& visible) {
    cv::GaussianBlur(view.texture(), reference_, {0, 0}, kBlur);
    cv::GaussianBlur(texture, present_, {0, 0}, kBlur);
    const auto mean_product = [this](const cv::Mat1f& a, const cv::Mat1f& b, cv::Mat1f& out) {
        cv::multiply(a, b, product_);
        patch_mean(product_, out);
    };
    mean_product(reference_, present_, ab_);
    mean_product(reference_, reference_, aa_);
    mean_product(present_, present_, bb_);
    correlations_.assign(view.samples().size(), 0);
    double in_sight = 0, alike = 0;
    for (std::size_t k = 0; k < view.samples().size(); ++k) {
        const ReferenceSample& sample = view.samples()[k];
        if (visible[k] <= 0) {
            continue;
        }
        const float own = aa_(sample.y, sample.x), other = bb_(sample.y, sample.x);
        correlations_[k] = ab_(sample.y, sample.x) / std::sqrt((own + kBare) * (other + kBare));
        const double share = sample.weight * visible[k] * own / (own + kBare);
        in_sight += share;
        alike += correlations_[k] > kAlike ? share : 0;
    }
    return in_sight > 0 ? alike / in_sight : 0;
}

}  // namespace mimetic
