// SPDX-License-Identifier: GPL-3.0-or-later
#include "point_regressor.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>

#include "crop_picture.hpp"
#include "network_file.hpp"

namespace mimetic::locate {
namespace {

constexpr int kSide = 64;
// As `scripts/build/eyes_and_lips/training.py` has them
constexpr double kLeastSpread = 0.003;
constexpr double kSmallestLog = -7, kLargestLog = 2;

}  // namespace

PointRegressor::PointRegressor(const std::string& file, int points, int groups) : points_(points) {
    try {
        net_ = load_network(file, {3, kSide, kSide}, {static_cast<std::size_t>(2 * points + groups)});
    } catch (const UnreadableMedia&) {  // it is part of the package, not of what set-up fetches
        throw UnreadableMedia(file + ": missing or damaged; install Mimetic again");
    }
}

RegressedPoints PointRegressor::see(const cv::Mat& blob) {
    const cv::Mat output = outputs_of(net_, standardised(blob))[0];
    const Eigen::Map<const Eigen::VectorXf> values(output.ptr<float>(),
                                                   static_cast<Eigen::Index>(output.total()));
    RegressedPoints seen;
    seen.shares = Eigen::Map<const Rows<float, 2>>(values.data(), points_, 2).cast<double>();
    seen.spread = values.tail(values.size() - 2 * points_).cast<double>();
    for (double& spread : seen.spread) {
        spread = kLeastSpread + std::exp(std::clamp(spread, kSmallestLog, kLargestLog));
    }
    return seen;
}

}  // namespace mimetic::locate
