// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_state.hpp"

#include "seen_point.hpp"

namespace mimetic {

void FaceState::apply(const FaceStep& step) {
    const Eigen::Matrix3d rotation = rotation_from_vector(step.rotation()) * camera_from_head.linear();
    camera_from_head.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    camera_from_head.translation() += step.translation();
    values += step.values();
}

void FaceState::keep_within(const FaceMotion& motion) {
    values = values.cwiseMax(motion.lower).cwiseMin(motion.upper);
}

FaceStep FaceState::difference_from(const FaceState& other) const {
    FaceStep step = FaceStep::none(values.size());
    step.rotation() =
        rotation_vector(camera_from_head.linear() * other.camera_from_head.linear().transpose());
    step.translation() = camera_from_head.translation() - other.camera_from_head.translation();
    step.values() = values - other.values;
    return step;
}

void skin_jacobian(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                   const Eigen::Vector3d& point_in_head, const Eigen::Matrix3Xf& modes,
                   Eigen::Matrix<float, 2, Eigen::Dynamic>& jacobian, Eigen::Matrix<double, 2, 3>& by_point) {
    const SeenPoint seen(camera, camera_from_head, point_in_head);
    by_point = seen.by_point;
    jacobian.resize(2, 6 + modes.cols());
    jacobian.leftCols<3>() = seen.by_rotation.cast<float>();
    jacobian.middleCols<3>(3) = seen.by_shift.cast<float>();
    jacobian.rightCols(modes.cols()).noalias() = by_point.cast<float>() * modes;
}

}  // namespace mimetic
