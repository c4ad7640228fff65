// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <mimetic/shared/types.hpp>
#include <opencv2/dnn.hpp>
#include <string>

namespace mimetic::locate {

/// What a regressor sees in a square, whose sides go from 0 to 1.
struct RegressedPoints {
    Points2 shares;
    Eigen::VectorXd spread;  ///< of each group of points: mean absolute error of a coordinate that it expects
};

/// A network of ours, fitted to drawn people by `scripts/train_eyes_and_lips`. A call at a time.
class PointRegressor {
public:
    PointRegressor() = default;
    /// Throws UnreadableMedia: missing, too large, or not such a network.
    PointRegressor(const std::string& file, int points, int groups);

    bool is_there() const { return !net_.empty(); }

    /// blob: 1 x 3 x 64 x 64 float32, red green blue in 0 to 1.
    RegressedPoints see(const cv::Mat& blob);

private:
    cv::dnn::Net net_;
    int points_ = 0;
};

}  // namespace mimetic::locate
