// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/blend.hpp"

namespace mimetic::fit {

Blend Blender::points(const std::vector<std::pair<int, double>>& weights) const {
    Blend sum;
    sum.modes = Eigen::Matrix3Xd::Zero(3, by_point_.cols());
    for (const auto& [index, weight] : weights) {
        sum.mean += weight * model_.points.row(index).transpose();
        sum.modes += weight * by_point_.middleRows<3>(3 * index);
    }
    return sum;
}

Blend Blender::landmark(int index) const {
    std::vector<std::pair<int, double>> weights;
    for (SparseRows::InnerIterator it(model_.landmark_weights, index); it; ++it) {
        weights.emplace_back(static_cast<int>(it.col()), it.value());
    }
    return points(weights);
}

int landmark_index(const FaceModel& model, const std::string& name) {
    for (std::size_t i = 0; i < model.landmark_names.size(); ++i) {
        if (model.landmark_names[i] == name) return static_cast<int>(i);
    }
    return -1;
}

Eigen::Vector3d landmark_at(const FaceModel& model, const Points& points, int index) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (SparseRows::InnerIterator it(model.landmark_weights, index); it; ++it) {
        sum += it.value() * points.row(it.col()).transpose();
    }
    return sum;
}

Camera with_focal(Camera camera, double focal) {
    camera.fx = camera.fy = focal;
    return camera;
}

}  // namespace mimetic::fit
