// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/widened.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic::locate {

namespace {

constexpr double kMargin = 0.2;  // of the longer side

int margin_of(const ColorView& image) {
    const int longer = std::max(image.rows, image.cols);
    return std::min(static_cast<int>(kMargin * longer), (kLargestImage - longer) / 2);
}

}  // namespace

Widened::Widened(ColorView image) : margin_(margin_of(image)) {
    cv::copyMakeBorder(as_matrix(image), wide_, margin_, margin_, margin_, margin_, cv::BORDER_REPLICATE);
}

ColorView Widened::view() const {
    return {wide_.data, wide_.rows, wide_.cols, static_cast<std::ptrdiff_t>(wide_.step)};
}

FaceFeatures Widened::in_picture(FaceFeatures face) const {
    face.box.head<2>().array() -= margin_;
    for (Feature& feature : face.features) {
        feature.position.array() -= margin_;
    }
    for (FeatureCurve& curve : face.curves) {
        curve.points.array() -= margin_;
    }
    return face;
}

}  // namespace mimetic::locate
