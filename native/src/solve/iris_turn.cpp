// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/locate/feature_noise.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/gaze.hpp>

namespace mimetic {
namespace {

constexpr double kHidden = .25;  // cosine: below, an eye is too oblique to be measured
constexpr double kFrontal = .7;  // cosine: above, as from the front
constexpr double kShut = .22;    // diameters of the iris between the lids: nothing is seen of it
constexpr double kOpen = .6;     // from here it is seen as well as in an open eye
// A lid that comes down takes the iris that networks see along, by 17 degrees to shut lids on drawn people
// who blink (docs/measured/speech.md), and sideways anywhere once little is seen.
constexpr double kPitchByLid = 10, kYawByLid = 10;  // degrees a share of the usual opening
constexpr double kLidAside = .3;                    // share of it that leaves yaw as it is
constexpr double kLargestFactor = 10;               // of the noise of nearly hidden irises
constexpr double kAtLimb = .97;                     // sine: beyond, an iris is at the eyeball's own outline
constexpr double kLargestStd = 20;                  // degrees
constexpr double kLeastPresence = .05;

/// Where the ray through a pixel meets the eyeball first, from its centre, head frame; its outline where the
/// ray misses it. sine: of the angle between that and the way to the camera.
struct BallPoint {
    Eigen::Vector3d direction;
    double sine;
};

BallPoint point_on_ball(const Camera& camera, const Eigen::Isometry3d& camera_from_head,
                        const Eigen::Vector3d& centre, double radius, const Eigen::Vector2d& pixel) {
    const Eigen::Isometry3d head_from_camera = camera_from_head.inverse();
    const Eigen::Vector3d ray = (head_from_camera.linear() * camera.ray(pixel.x(), pixel.y())).normalized();
    const Eigen::Vector3d from_eye = head_from_camera.translation() - centre;
    const Eigen::Vector3d across = from_eye - from_eye.dot(ray) * ray;  // the ray's nearest point
    const double sine = across.norm() / radius;
    if (sine >= kAtLimb) {
        const double cosine = std::sqrt(1 - kAtLimb * kAtLimb);
        return {kAtLimb * across.normalized() - cosine * ray, sine};
    }
    return {across / radius - std::sqrt(1 - sine * sine) * ray, sine};
}

/// Variances of yaw and pitch, by how far the lids are more shut than usual.
Eigen::Vector2d lid_variances(double opening, double usual) {
    const double shut = usual > 0 ? std::clamp(1 - opening / usual, 0., 1.) : 0;
    return Eigen::Vector2d(kYawByLid * std::max(0., shut - kLidAside), kPitchByLid * shut).cwiseAbs2();
}

Eigen::Vector2d vector_of(const EyeAngles& angles) { return {angles.yaw, angles.pitch}; }

}  // namespace

void Eyeballs::check() const {
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!centres[eye].allFinite() || !(radii[eye] > 1e-4 && radii[eye] < 1) || !facing[eye].allFinite() ||
            !(facing[eye].norm() > 0)) {
            throw InvalidInput("an eyeball needs a finite centre, a radius in metres and a way it faces");
        }
    }
}

IrisTurn iris_turn(const Camera& camera, const Eyeballs& eyes, const GazeFrame& frame, int eye,
                   const UsualOpening& usual) {
    const auto at = static_cast<std::size_t>(eye);
    const SeenIris& iris = frame.irises[at];
    const Eigen::Vector3d centre = eyes.centres[at], in_camera = frame.camera_from_head * centre;
    IrisTurn turn;
    if (!(iris.side > 0) || !iris.center.allFinite() || !(iris.presence > kLeastPresence) ||
        !(iris.opening > kShut) || !(in_camera.z() > 1e-2)) {
        return turn;
    }
    const double frontality =
        -(frame.camera_from_head.linear() * eyes.facing[at].normalized()).dot(in_camera.normalized());
    if (frontality <= kHidden) {
        return turn;
    }
    const auto angles_at = [&](const Eigen::Isometry3d& pose, const Eigen::Vector2d& pixel) {
        return gaze_angles(point_on_ball(camera, pose, centre, eyes.radii[at], pixel).direction);
    };
    turn.is_seen = true;
    turn.angles = angles_at(frame.camera_from_head, iris.center);
    const double sight = std::min(1., (frontality - kHidden) / (kFrontal - kHidden)) * iris.presence *
                         std::min(1., (iris.opening - kShut) / (kOpen - kShut));
    const double factor = std::min(kLargestFactor, iris.doubt / sight);
    const double step = .02 * eyes.radii[at] * camera.fx / in_camera.z();  // pixels
    Eigen::Matrix2d by_pixel;
    for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d aside = step * Eigen::Vector2d::Unit(axis);
        by_pixel.col(axis) = (vector_of(angles_at(frame.camera_from_head, iris.center + aside)) -
                              vector_of(angles_at(frame.camera_from_head, iris.center - aside))) /
                             (2 * step);
    }
    const FeatureNoise noise = feature_noise(NetworkFeature::iris, iris.side);
    const auto covariance_of = [&](const Eigen::Vector2d& sides) -> Eigen::Matrix2d {
        const Eigen::Matrix2d scaled = by_pixel * (factor * iris.side * sides).asDiagonal();
        return scaled * scaled.transpose();
    };
    turn.jitter = covariance_of(noise.jitter);
    turn.jitter.diagonal() += lid_variances(iris.opening, usual[at]);
    turn.lasting = covariance_of(noise.error);
    Eigen::Matrix<double, 2, 6> by_pose;
    constexpr double kStep = 1e-4;  // radians, metres
    for (int axis = 0; axis < 6; ++axis) {
        Eigen::Isometry3d pose = frame.camera_from_head;
        if (axis < 3) {
            pose.linear() = Eigen::AngleAxisd(kStep, Eigen::Vector3d::Unit(axis)) * pose.linear();
        } else {
            pose.translation()[axis - 3] += kStep;
        }
        by_pose.col(axis) = (vector_of(angles_at(pose, iris.center)) - vector_of(turn.angles)) / kStep;
    }
    turn.lasting += by_pose * frame.pose_cov * by_pose.transpose();
    const BallPoint point =
        point_on_ball(camera, frame.camera_from_head, centre, eyes.radii[at], iris.center);
    if (point.sine >= kAtLimb) {
        turn.jitter = turn.lasting = kLargestStd * kLargestStd * Eigen::Matrix2d::Identity();
    }
    return turn;
}

}  // namespace mimetic
