// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/locate/eye_regressor.hpp>
#include <mutex>

#include "crop_picture.hpp"
#include "joined_eye.hpp"

namespace mimetic {
namespace {

// Times the networks' error on real faces marked by hand where the regressor expects no more than usual: 1.3
// and 1.4 in five clips once the person's bias is known, which is larger, too (docs/measured/real-faces.md).
constexpr double kLids = 1.5, kIris = 2;

/// Margins that end in common corners, as the networks' contour has them.
Points2 contour_of(const Points2& shares) {
    Points2 contour(EyePoints::kRoundEye, 2);
    for (int i = 0; i < locate::RegressedEye::kMargin; ++i) {
        contour.row(LidMargins::kUpper[static_cast<std::size_t>(i)]) = shares.row(i);
    }
    for (int i = 0; i < locate::RegressedEye::kMargin; ++i) {
        const auto lower = shares.row(locate::RegressedEye::kMargin + i);
        const int point = LidMargins::kLower[static_cast<std::size_t>(i)];
        const bool is_corner = i == 0 || i + 1 == locate::RegressedEye::kMargin;
        contour.row(point) = is_corner ? (0.5 * (contour.row(point) + lower)).eval() : lower;
    }
    return contour;
}

}  // namespace

struct EyeRegressor::Net {
    std::mutex busy;
    locate::PointRegressor points;
};

EyeRegressor::EyeRegressor(const std::string& file) : net_(std::make_unique<Net>()) {
    net_->points = locate::PointRegressor(file, locate::RegressedEye::kPoints, locate::RegressedEye::kGroups);
}

EyeRegressor::~EyeRegressor() = default;
EyeRegressor::EyeRegressor(EyeRegressor&&) noexcept = default;
EyeRegressor& EyeRegressor::operator=(EyeRegressor&&) noexcept = default;

EyePoints EyeRegressor::eye(ColorView image, const FeatureCrop& crop, bool left) const {
    check_image_size(image.rows, image.cols, "image");
    crop.check();
    const cv::Mat blob = locate::blob_of(image, crop, locate::kEyeSide, left);
    const locate::RegressedPoints seen = [&] {
        const std::lock_guard lock(net_->busy);
        return net_->points.see(blob);
    }();
    EyePoints points{locate::in_picture(contour_of(seen.shares), crop, left),
                     locate::in_picture(seen.shares.bottomRows(EyePoints::kIris), crop, left)};
    points.lid_doubt = kLids * std::max(locate::lid_doubt(seen.spread[0]), locate::lid_doubt(seen.spread[1]));
    points.iris_doubt = kIris * locate::iris_doubt(seen.spread[2]);
    return points;
}

}  // namespace mimetic
