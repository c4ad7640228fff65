// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigid_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

namespace mimetic::head {
namespace {

constexpr int kMaxSteps = 12;
constexpr double kTukey = 4.7;          // scales: 95 % efficient under Gaussian noise
constexpr double kPatch = 0.025;        // metres over which a model's error is one
constexpr double kLeastDepth = 0.05;    // metres
constexpr double kMaxTurn = 0.7;        // rad a step
constexpr double kPriorRotation = 2.0;  // rad and metres: s.d. that keep a plane's depth from running away
constexpr double kPriorTranslation = 0.5;

constexpr int kNumUnknowns = 6 + kNumExpressions;

using Jacobian = Eigen::Matrix<double, 2, 6>;
using MovementJacobian = Eigen::Matrix<double, 2, kNumExpressions>;
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using Information = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;

struct Row {
    Eigen::Vector2d residual;
    double distance = 0;  // normalised by the flow's covariance
};

struct State {
    Eigen::Isometry3d pose;
    Expression expression;
};

/// Of one measurement in the image, by what is not known.
struct Derivative {
    Jacobian by_pose;
    MovementJacobian by_expression;
};

Eigen::Vector3d point_of(const State& state, const PointMeasurement& m) {
    return m.movements ? Eigen::Vector3d(m.point + *m.movements * state.expression) : m.point;
}

Derivative derivative_of(const Camera& camera, const State& state, const PointMeasurement& m) {
    const Eigen::Vector3d turned = state.pose.linear() * point_of(state, m);
    Derivative found;
    const auto in_image = camera.project_jacobian(turned + state.pose.translation());
    found.by_pose.leftCols<3>() << in_image * (Eigen::Matrix3d() << 0, turned.z(), -turned.y(),  //
                                               -turned.z(), 0, turned.x(),                       //
                                               turned.y(), -turned.x(), 0)
                                                  .finished();
    found.by_pose.rightCols<3>() = in_image;
    if (m.movements) {
        found.by_expression = (in_image * state.pose.linear()) * *m.movements;
    }
    return found;
}

double median_of(std::vector<double>& values) {
    if (values.empty()) {
        return 0;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double tukey(double distance, double scale) {
    const double x = distance / (kTukey * scale);
    return x < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

/// Distances of the measurements from a state; false if it is behind the camera.
bool compare(const Camera& camera, const State& state, const std::vector<PointMeasurement>& measurements,
             std::vector<Row>& rows) {
    rows.resize(measurements.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const PointMeasurement& m = measurements[k];
        const Eigen::Vector3d point = state.pose * point_of(state, m);
        if (!(point.z() > kLeastDepth)) {
            return false;
        }
        rows[k].residual = m.pixel - camera.project(point);
        rows[k].distance = std::sqrt(std::max(0., rows[k].residual.dot(m.information * rows[k].residual)));
    }
    return true;
}

double scale_of(const std::vector<Row>& rows) {
    std::vector<double> distances;
    for (const Row& row : rows) {
        distances.push_back(row.distance);
    }
    constexpr double kMedianOfTwo = 1.18;  // of a distance in two dimensions, s.d. 1
    return std::max(.5, median_of(distances) / kMedianOfTwo);
}

State moved(const State& state, const Unknowns& step) {
    State next = state;
    const double angle = step.head<3>().norm();
    if (angle > 1e-12) {
        next.pose.linear() =
            Eigen::AngleAxisd(std::min(angle, kMaxTurn), step.head<3>() / angle) * state.pose.linear();
    }
    next.pose.translation() += step.segment<3>(3);
    next.expression += step.tail<kNumExpressions>();
    return next;
}

Unknowns prior_information(double angle, const Expression& expression) {
    Unknowns information;
    information << Eigen::Vector3d::Constant(std::pow(kPriorRotation, -2)),
        Eigen::Vector3d::Constant(std::pow(kPriorTranslation, -2)),
        Expression::Constant(expression_precision(angle, expression));
    return information;
}

/// Adds to the upper triangle.
void add(const Derivative& by, const PointMeasurement& m, double weight, Information& information) {
    const Jacobian weighted = weight * m.information * by.by_pose;
    information.topLeftCorner<6, 6>().noalias() += by.by_pose.transpose() * weighted;
    if (m.movements) {
        information.topRightCorner<6, kNumExpressions>().noalias() += weighted.transpose() * by.by_expression;
        information.bottomRightCorner<kNumExpressions, kNumExpressions>().noalias() +=
            by.by_expression.transpose() * (weight * m.information * by.by_expression);
    }
}

void pull_by(const Derivative& by, const PointMeasurement& m, const Eigen::Vector2d& shift, Unknowns& sum) {
    sum.head<6>() += by.by_pose.transpose() * shift;
    if (m.movements) {
        sum.tail<kNumExpressions>() += by.by_expression.transpose() * shift;
    }
}

/// Noise of the pixels, and what an error of the model, one over each patch of skin, does to the pose.
Matrix6 covariance_of(const Camera& camera, const State& state,
                      const std::vector<PointMeasurement>& measurements, const std::vector<Row>& rows,
                      const Unknowns& prior, double scale) {
    Information information = prior.asDiagonal();
    std::map<std::pair<int, int>, Unknowns> pulls;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const PointMeasurement& m = measurements[k];
        const double weight = tukey(rows[k].distance, scale) * m.weight;
        const Derivative by = derivative_of(camera, state, m);
        add(by, m, weight, information);
        const Eigen::Vector2d shift =
            weight * m.information * (by.by_pose.rightCols<3>() * (state.pose.linear() * m.depth_error));
        auto [pull, is_new] = pulls.try_emplace({static_cast<int>(std::floor(m.point.x() / kPatch)),
                                                 static_cast<int>(std::floor(m.point.y() / kPatch))},
                                                Unknowns::Zero());
        pull_by(by, m, shift, pull->second);
    }
    const Information full = information.selfadjointView<Eigen::Upper>();
    const Eigen::Matrix<double, kNumUnknowns, 6> inverse =
        full.llt().solve(Eigen::Matrix<double, kNumUnknowns, 6>::Identity());
    Matrix6 spread = Matrix6::Zero();
    for (const auto& [patch, pull] : pulls) {
        const Vector6 moves = inverse.transpose() * pull;
        spread += moves * moves.transpose();
    }
    const Matrix6 covariance = inverse.topRows<6>() * std::max(1., scale * scale) + spread;
    return .5 * (covariance + covariance.transpose());
}

}  // namespace

RigidMotion explain_motion(const Camera& camera, const Eigen::Isometry3d& start,
                           const Expression& expression_start, double angle,
                           const std::vector<PointMeasurement>& measurements) {
    RigidMotion motion;
    motion.camera_from_head = start;
    std::vector<Row> rows;
    State state{start, expression_start};
    Unknowns prior = prior_information(angle, expression_start);
    if (measurements.empty() || !compare(camera, state, measurements, rows)) {
        motion.covariance = prior.head<6>().cwiseInverse().asDiagonal();
        return motion;
    }
    double scale = scale_of(rows);
    for (int step = 0; step < kMaxSteps; ++step) {
        prior = prior_information(angle, state.expression);
        Information information = prior.asDiagonal();
        Unknowns gradient = Unknowns::Zero();
        gradient.tail<kNumExpressions>() = -prior.tail<kNumExpressions>().cwiseProduct(state.expression);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const PointMeasurement& m = measurements[k];
            const double weight = tukey(rows[k].distance, scale) * m.weight;
            if (weight > 0) {
                const Derivative by = derivative_of(camera, state, m);
                add(by, m, weight, information);
                pull_by(by, m, weight * m.information * rows[k].residual, gradient);
            }
        }
        const Unknowns change = information.selfadjointView<Eigen::Upper>().llt().solve(gradient);
        const State next = moved(state, change);
        if (!change.allFinite() || !compare(camera, next, measurements, rows)) {
            compare(camera, state, measurements, rows);
            break;
        }
        state = next;
        scale = scale_of(rows);
        if (change.head<3>().norm() < 1e-5 && change.segment<3>(3).norm() < 1e-6) {
            break;
        }
    }
    motion.camera_from_head = state.pose;
    motion.expression = state.expression;
    std::vector<double> distances;
    double sum = 0;
    constexpr double kNear = 2;  // pixels of the camera
    for (const Row& row : rows) {
        distances.push_back(row.residual.norm());
        sum += distances.back() < kNear;
    }
    motion.explained = sum / static_cast<double>(rows.size());
    motion.residual_px = median_of(distances);
    motion.covariance = covariance_of(camera, state, measurements, rows, prior, scale);
    return motion;
}

}  // namespace mimetic::head
