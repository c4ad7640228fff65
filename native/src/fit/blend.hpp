// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/fit.hpp>

namespace mimetic::fit {

/// A weighted sum of the model's points and of what the modes do to it.
struct Blend {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd modes;  ///< 3 x I

    Eigen::Vector3d at(VectorIn identity) const { return mean + modes * identity; }
};

Blend blend(const FaceModel& model, const std::vector<std::pair<int, double>>& weights);
Blend landmark(const FaceModel& model, int index);
int landmark_index(const FaceModel& model, const std::string& name);  ///< -1 if there is none
Eigen::Vector3d landmark_at(const FaceModel& model, const Points& points, int index);
Camera with_focal(Camera camera, double focal);

}  // namespace mimetic::fit
