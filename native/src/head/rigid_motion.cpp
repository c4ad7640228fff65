// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <mimetic/shared/rotations.hpp>

#include "shared/robust.hpp"

namespace mimetic::head {
namespace {

constexpr int kMaxSteps = 12;
constexpr double kPatch = 0.025;        // metres: correlation length of a model's error
constexpr double kLeastDepth = 0.05;    // metres
constexpr double kMaxTurn = 0.7;        // rad a step
constexpr double kPriorRotation = 2.0;  // rad and metres: s.d. that keep a plane's depth from diverging
constexpr double kPriorTranslation = 0.5;

using Jacobian = Eigen::Matrix<double, 2, 6>;

struct Row {
    Eigen::Vector2d residual;
    double distance = 0;  // normalised by the flow's covariance
};

Jacobian jacobian_of(const Camera& camera, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
    const Eigen::Vector3d turned = pose.linear() * point;
    Jacobian jacobian;
    const auto in_image = camera.project_jacobian(turned + pose.translation());
    jacobian.leftCols<3>() << in_image * (Eigen::Matrix3d() << 0, turned.z(), -turned.y(),  //
                                          -turned.z(), 0, turned.x(),                       //
                                          turned.y(), -turned.x(), 0)
                                             .finished();
    jacobian.rightCols<3>() = in_image;
    return jacobian;
}

/// Distances of the measurements from a pose; false if it is behind the camera.
bool compare(const Camera& camera, const Eigen::Isometry3d& pose,
             const std::vector<PointMeasurement>& measurements, std::vector<Row>& rows) {
    rows.resize(measurements.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Eigen::Vector3d point = pose * measurements[k].point;
        if (!(point.z() > kLeastDepth)) {
            return false;
        }
        rows[k].residual = measurements[k].pixel - camera.project(point);
        rows[k].distance =
            std::sqrt(std::max(0., rows[k].residual.dot(measurements[k].information * rows[k].residual)));
    }
    return true;
}

double scale_of(const std::vector<Row>& rows) {
    std::vector<double> distances;
    distances.reserve(rows.size());
    for (const Row& row : rows) {
        distances.push_back(row.distance);
    }
    constexpr double kMedianOfTwo = 1.18;  // of a distance in two dimensions, s.d. 1
    return std::max(.5, upper_median(distances) / kMedianOfTwo);
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Vector6& step) {
    Eigen::Isometry3d next = pose;
    next.linear() = rotation_from_vector(step.head<3>(), kMaxTurn) * pose.linear();
    next.translation() += step.tail<3>();
    return next;
}

Matrix6 prior_information() {
    Vector6 diagonal;
    diagonal << Eigen::Vector3d::Constant(std::pow(kPriorRotation, -2)),
        Eigen::Vector3d::Constant(std::pow(kPriorTranslation, -2));
    return diagonal.asDiagonal();
}

/// Noise of the pixels, and what an error of the model, one over each patch of skin, does to the pose.
Matrix6 covariance_of(const Camera& camera, const Eigen::Isometry3d& pose,
                      const std::vector<PointMeasurement>& measurements, const std::vector<Row>& rows,
                      double scale) {
    Matrix6 information = prior_information();
    std::map<std::pair<int, int>, Vector6> pulls;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const PointMeasurement& m = measurements[k];
        const double weight = tukey_weight(rows[k].distance / (kTukeyCut * scale)) * m.weight;
        const Jacobian jacobian = jacobian_of(camera, pose, m.point);
        const Eigen::Matrix<double, 6, 2> gain = weight * jacobian.transpose() * m.information;
        information += gain * jacobian;
        const Eigen::Vector2d shift = jacobian.rightCols<3>() * (pose.linear() * m.depth_error);
        auto [pull, is_new] = pulls.try_emplace({static_cast<int>(std::floor(m.point.x() / kPatch)),
                                                 static_cast<int>(std::floor(m.point.y() / kPatch))},
                                                Vector6::Zero());
        pull->second += gain * shift;
    }
    const Matrix6 inverse = information.llt().solve(Matrix6::Identity());
    Matrix6 spread = Matrix6::Zero();
    for (const auto& [patch, pull] : pulls) {
        spread += pull * pull.transpose();
    }
    const Matrix6 covariance = inverse * std::max(1., scale * scale) + inverse * spread * inverse.transpose();
    return .5 * (covariance + covariance.transpose());
}

}  // namespace

RigidMotion explain_motion(const Camera& camera, const Eigen::Isometry3d& start,
                           const std::vector<PointMeasurement>& measurements) {
    RigidMotion motion;
    motion.camera_from_head = start;
    std::vector<Row> rows;
    if (measurements.empty() || !compare(camera, start, measurements, rows)) {
        motion.covariance = prior_information().inverse();
        return motion;
    }
    double scale = scale_of(rows);
    for (int step = 0; step < kMaxSteps; ++step) {
        Matrix6 information = prior_information();
        Vector6 gradient = Vector6::Zero();
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double weight =
                tukey_weight(rows[k].distance / (kTukeyCut * scale)) * measurements[k].weight;
            if (weight > 0) {
                const Jacobian jacobian = jacobian_of(camera, motion.camera_from_head, measurements[k].point);
                const Eigen::Matrix<double, 6, 2> gain =
                    weight * jacobian.transpose() * measurements[k].information;
                information += gain * jacobian;
                gradient += gain * rows[k].residual;
            }
        }
        const Vector6 change = information.llt().solve(gradient);
        const Eigen::Isometry3d next = moved(motion.camera_from_head, change);
        if (!change.allFinite() || !compare(camera, next, measurements, rows)) {
            compare(camera, motion.camera_from_head, measurements, rows);
            break;
        }
        motion.camera_from_head = next;
        scale = scale_of(rows);
        if (change.head<3>().norm() < 1e-5 && change.tail<3>().norm() < 1e-6) {
            break;
        }
    }
    std::vector<double> distances;
    double sum = 0;
    constexpr double kNear = 2;  // pixels of the camera
    for (const Row& row : rows) {
        distances.push_back(row.residual.norm());
        sum += distances.back() < kNear;
    }
    motion.explained = sum / static_cast<double>(rows.size());
    motion.residual_px = upper_median(distances);
    motion.covariance = covariance_of(camera, motion.camera_from_head, measurements, rows, scale);
    return motion;
}

}  // namespace mimetic::head
