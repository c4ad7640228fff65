// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/fit/fit.hpp>

namespace mimetic::fit {

/// A weighted sum of the model's points, and its displacement by the modes.
struct Blend {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd modes;  ///< 3 x I

    Eigen::Vector3d at(VectorIn identity) const { return mean + modes * identity; }
};

/// Gives blends of a model's points; a copy of the modes keeps those of one point together in memory.
class Blender {
public:
    explicit Blender(const FaceModel& model) : model_(model), by_point_(model.modes.transpose()) {}

    Blend points(const std::vector<std::pair<int, double>>& weights) const;
    Blend landmark(int index) const;

private:
    const FaceModel& model_;
    MatrixRows by_point_;  // 3P x I
};

int landmark_index(const FaceModel& model, const std::string& name);  ///< -1 if there is none
Eigen::Vector3d landmark_at(const FaceModel& model, const Points& points, int index);
Camera with_focal(Camera camera, double focal);

}  // namespace mimetic::fit
