// SPDX-License-Identifier: GPL-3.0-or-later
#include "template_variants.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace mimetic::puppet {

namespace {

constexpr int kLeastSide = 4;  // pixels of what is searched with

/// As images are halved.
cv::Mat1b halved(const cv::Mat1b& picture) {
    ImageLevel whole, half;
    whole.load({picture.data, picture.rows, picture.cols, static_cast<std::ptrdiff_t>(picture.step)});
    half.load_half(whole);
    cv::Mat1b pixels(half.rows(), half.cols());
    for (int y = 0; y < half.rows(); ++y) {
        std::copy_n(half.row(y), half.cols(), pixels[y]);
    }
    return pixels;
}

/// Turned about its centre and resized; where it has no pixels those at its edge are repeated.
cv::Mat1b turned(const cv::Mat1b& picture, double scale, double rotation) {
    if (scale == 1 && rotation == 0) {
        return picture;
    }
    const cv::Size size(std::max(kLeastSide, cvRound(scale * picture.cols)),
                        std::max(kLeastSide, cvRound(scale * picture.rows)));
    const double c = std::cos(rotation) / scale, s = std::sin(rotation) / scale;
    const double from_x = .5 * (size.width - 1), from_y = .5 * (size.height - 1);
    const double to_x = .5 * (picture.cols - 1), to_y = .5 * (picture.rows - 1);
    const cv::Matx23d picture_from_variant(c, s, to_x - c * from_x - s * from_y,  //
                                           -s, c, to_y + s * from_x - c * from_y);
    cv::Mat1b variant;
    cv::warpAffine(picture, variant, picture_from_variant, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return variant;
}

Kernel kernel_of(const cv::Mat1b& picture) {
    const cv::Mat1b whole = picture.isContinuous() ? picture : picture.clone();
    return {whole.data, whole.rows, whole.cols};
}

}  // namespace

PreparedTemplate prepare(const LookTemplate& look, const MatchOptions& options) {
    const GrayPicture& from = look.picture;
    // OpenCV has no read-only matrix; nothing here writes to it.
    cv::Mat1b picture(from.rows, from.cols, const_cast<std::uint8_t*>(from.pixels.data()));
    PreparedTemplate prepared;
    prepared.place = look.place;
    prepared.group = look.group;
    while (picture.rows * picture.cols > options.most_pixels &&
           std::min(picture.rows, picture.cols) >= 4 * kLeastSide) {
        // The centre of what is left, where a side was odd
        prepared.trim += std::ldexp(.5, prepared.level) * Eigen::Vector2d(picture.cols % 2, picture.rows % 2);
        picture = halved(picture);
        ++prepared.level;
    }
    for (const double scale : options.scales) {
        for (const double rotation : options.rotations) {
            const cv::Mat1b variant = turned(picture, scale, rotation);
            prepared.variants.push_back({scale, rotation, kernel_of(variant), kernel_of(halved(variant))});
        }
    }
    return prepared;
}

}  // namespace mimetic::puppet
