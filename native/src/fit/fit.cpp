// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>

#include "fit/blend.hpp"
#include "fit/outline.hpp"
#include "fit/partner.hpp"
#include "fit/residuals.hpp"

namespace mimetic {
namespace {

using fit::Blend;
using fit::EdgePoint;
using fit::landmark_index;
using fit::with_focal;
using Pose = Eigen::Matrix<double, fit::kPose, 1>;
using Weight = Eigen::Matrix<double, Eigen::Dynamic, 2>;

constexpr double kIpdTolerance = 5e-5;  // metres

/// A curve's stations lie closer than the correlation length of its errors.
constexpr double kCurveInflation = 1.8;

/// Interpupillary distances within which a measured line and the model's may be matched.
constexpr double kReach = 0.35;

/// Interpupillary distances by which a rigid average head may miss a pin.
constexpr double kRigidPin = 0.03;

/// Factor on a line's standard deviation where a landmark of its name was placed by hand: it was wrong there.
constexpr double kPinnedLine = 4.0;

/// Rounds from an estimate that was good before a small change.
constexpr int kRestarted = 3;

/// The solver's parameters.
struct State {
    std::vector<Pose> poses;  // rotation vector and translation of camera_from_head
    double log_focal = 0;
    Eigen::VectorXd identity;

    double moved_from(const State& before) const {
        double moved = 0.01 * (identity - before.identity).norm();
        for (std::size_t v = 0; v < poses.size(); ++v) {
            moved = std::max(moved, (poses[v] - before.poses[v]).norm());
        }
        return moved;
    }
};

Eigen::Isometry3d as_transform(const Pose& pose) {
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
    transform.linear() = rotation_from_vector(pose.head<3>());
    transform.translation() = pose.tail<3>();
    return transform;
}

Pose as_parameters(const Eigen::Isometry3d& camera_from_head) {
    Pose pose;
    pose << rotation_vector(camera_from_head.linear()), camera_from_head.translation();
    return pose;
}

/// Initial pose: upright, facing the camera, placed by the pupils.
Pose first_guess(const FaceModel& model, const FaceFeatures& features, const Camera& camera) {
    const Eigen::Vector2d right = features.find("pupil.R")->position;
    const Eigen::Vector2d left = features.find("pupil.L")->position;
    const Eigen::Vector3d eye_right = fit::landmark_at(model, model.points, landmark_index(model, "pupil.R"));
    const Eigen::Vector3d eye_left = fit::landmark_at(model, model.points, landmark_index(model, "pupil.L"));
    const Eigen::Vector2d across = left - right;
    Eigen::Matrix3d flip =
        Eigen::Vector3d(1, -1, -1).asDiagonal();  // y up, z to the viewer -> y down, z away
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(std::atan2(across.y(), across.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix() *
        flip;
    const double depth = camera.fx * (eye_left - eye_right).norm() / across.norm();
    const Eigen::Vector2d middle = (left + right) / 2;
    const Eigen::Vector3d middle_in_camera(depth * (middle.x() - camera.cx) / camera.fx,
                                           depth * (middle.y() - camera.cy) / camera.fx, depth);
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
    camera_from_head.linear() = rotation;
    camera_from_head.translation() = middle_in_camera - rotation * (eye_left + eye_right) / 2;
    return as_parameters(camera_from_head);
}

class FaceFitter {
public:
    FaceFitter(const FaceModel& model, const std::vector<FaceView>& views, const Camera& camera,
               const FitOptions& options)
        : model_(model), views_(views), camera_(camera), options_(options), blender_(model) {
        for (const auto& view : views) {
            const FaceFeatures& seen = view.features;
            ipd_px_.push_back((seen.find("pupil.L")->position - seen.find("pupil.R")->position).norm());
        }
    }

    FaceEstimate run(const FaceEstimate* start) {
        FaceEstimate estimate;
        if (start == nullptr) {
            state_.log_focal = std::log(camera_.fx);
            state_.identity = Eigen::VectorXd::Zero(model_.modes.rows());
            for (const auto& view : views_)
                state_.poses.push_back(first_guess(model_, view.features, camera_));
            // Pose alone first: proportions must not compensate for a rotation. The loss starts wide, since
            // a feature that is far off only because the head is must not be given up.
            robust_scale_ = 8 * options_.robust_scale;
            solve(false, estimate);
        } else {
            state_.log_focal = std::log(start->focal);
            state_.identity = start->identity.cwiseMax(model_.limits.col(0)).cwiseMin(model_.limits.col(1));
            for (const auto& pose : start->camera_from_head) state_.poses.push_back(as_parameters(pose));
        }
        const int fewest = start == nullptr ? 3 : 0;
        const int most = start == nullptr ? options_.max_rounds : std::min(options_.max_rounds, kRestarted);
        for (int round = 0; round < most; ++round) {
            const State before = state_;
            robust_scale_ = std::max(1.0, std::exp2(fewest - round)) * options_.robust_scale;
            solve(options_.shape_free, estimate);
            if (round >= fewest && state_.moved_from(before) < 2e-4) break;
        }
        for (const auto& pose : state_.poses) estimate.camera_from_head.push_back(as_transform(pose));
        estimate.focal = std::exp(state_.log_focal);
        estimate.identity = state_.identity;
        return estimate;
    }

private:
    /// loss: nullptr for plain least squares, as of pins
    void add(ceres::Problem& problem, std::size_t view, const Blend& point, const Eigen::Vector2d& observed,
             const Weight& weight, double sigma_px, ceres::LossFunction* loss) {
        problem.AddResidualBlock(new fit::ProjectionResidual(point.mean, point.modes, observed,
                                                             weight / sigma_px, {camera_.cx, camera_.cy}),
                                 loss, state_.poses[view].data(), &state_.log_focal, state_.identity.data());
        measured_.push_back({sigma_px, ipd_px_[view]});
    }

    ceres::LossFunction* robust() const { return new ceres::CauchyLoss(robust_scale_); }

    void add_features(ceres::Problem& problem, std::size_t view) {
        const FaceFeatures& seen = views_[view].features;
        for (const auto& feature : seen.features) {
            const int index = landmark_index(model_, feature.name);
            // A curve of the same name measures the position across it only
            if (index < 0 || feature.likelihood < 0.05 || seen.find_curve(feature.name) != nullptr) continue;
            if (is_pinned(view, feature.name)) continue;
            double sigma = distrust(view) * feature.sigma_px;
            if (feature.name.starts_with("pupil."))
                sigma = std::hypot(sigma, distrust(view) * options_.gaze_spread * ipd_px_[view]);
            add(problem, view, blender_.landmark(index), feature.position, Eigen::Matrix2d::Identity(), sigma,
                robust());
        }
    }

    void add_pins(ceres::Problem& problem, std::size_t view, bool shape) {
        for (const auto& pin : views_[view].pins) {
            const double sigma = std::max(pin.sigma_px, shape ? 0.0 : kRigidPin * ipd_px_[view]);
            add(problem, view, blender_.landmark(landmark_index(model_, pin.name)), pin.position,
                Eigen::Matrix2d::Identity(), sigma, shape ? nullptr : robust());
        }
    }

    /// Factor on a view's measured standard deviations.
    double distrust(std::size_t view) const { return view == 0 ? 1.0 : options_.elsewhere; }

    void add_motion(ceres::Problem& problem, std::size_t view) {
        for (const auto& motion : views_[view].motion) {
            const Blend point = blender_.points({{motion.point, 1.0}});
            problem.AddResidualBlock(new fit::MotionResidual(point.mean, point.modes, motion.shift,
                                                             motion.sigma_px, {camera_.cx, camera_.cy}),
                                     robust(), state_.poses[0].data(), state_.poses[view].data(),
                                     &state_.log_focal, state_.identity.data());
        }
    }

    bool is_pinned(std::size_t view, const std::string& name) const {
        const auto& pins = views_[view].pins;
        return std::any_of(pins.begin(), pins.end(), [&](const Feature& pin) { return pin.name == name; });
    }

    void add_curves(ceres::Problem& problem, std::size_t view, const Points& points, bool shape) {
        const Eigen::Isometry3d camera_from_head = as_transform(state_.poses[view]);
        const Camera camera = with_focal(camera_, std::exp(state_.log_focal));
        const double reach = kReach * ipd_px_[view];
        Points2 pixels(points.rows(), 2);
        for (const auto& chain : model_.curves) {
            for (const int i : chain)
                pixels.row(i) = camera.project(camera_from_head * points.row(i).transpose());
        }
        for (const auto& curve : views_[view].features.curves) {
            const bool is_jaw = curve.name == "jaw";
            const auto known = std::find(model_.curve_names.begin(), model_.curve_names.end(), curve.name);
            if (is_jaw ? !shape : known == model_.curve_names.end()) continue;
            std::vector<EdgePoint> edge;
            if (is_jaw) edge = fit::outline(model_, points, camera_from_head, camera);
            const double doubt =
                distrust(view) * kCurveInflation * (is_pinned(view, curve.name) ? kPinnedLine : 1.0);
            for (int i = 0; i < curve.points.rows(); ++i) {
                const fit::Station station{curve.points.row(i), curve.normals.row(i)};
                const auto number = static_cast<std::size_t>(known - model_.curve_names.begin());
                const std::optional<EdgePoint> match =
                    is_jaw ? fit::partner_among(edge, station, reach)
                           : fit::partner_on_line(model_.curves[number], pixels, station, reach);
                if (!match) continue;
                add(problem, view,
                    blender_.points({{match->first, 1 - match->fraction}, {match->second, match->fraction}}),
                    station.place, station.normal.transpose(), doubt * curve.sigma_px(i), robust());
            }
        }
    }

    void add_priors(ceres::Problem& problem, bool shape) {
        const Blend left = blender_.landmark(landmark_index(model_, "pupil.L"));
        const Blend right = blender_.landmark(landmark_index(model_, "pupil.R"));
        problem.AddResidualBlock(
            new fit::IdentityResidual(model_.spread, left.mean - right.mean, left.modes - right.modes,
                                      options_.pupil_distance, kIpdTolerance),
            nullptr, state_.identity.data());
        for (auto& pose : state_.poses) {
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<fit::FacingResidual, 2, fit::kPose>(
                                         new fit::FacingResidual{options_.pitch_spread, options_.yaw_spread}),
                                     nullptr, pose.data());
            if (!options_.pose_free) problem.SetParameterBlockConstant(pose.data());
        }
        for (int i = 0; i < model_.limits.rows(); ++i) {
            problem.SetParameterLowerBound(state_.identity.data(), i, model_.limits(i, 0));
            problem.SetParameterUpperBound(state_.identity.data(), i, model_.limits(i, 1));
        }
        if (!shape) problem.SetParameterBlockConstant(state_.identity.data());
        if (options_.focal_free && shape) {
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<fit::FocalResidual, 1, 1>(
                                         new fit::FocalResidual{std::log(camera_.fx), options_.focal_spread}),
                                     nullptr, &state_.log_focal);
        } else {
            problem.SetParameterBlockConstant(&state_.log_focal);
        }
    }

    void solve(bool shape, FaceEstimate& estimate) {
        ceres::Problem problem;
        measured_.clear();
        const Points points = model_.shaped(state_.identity);
        for (std::size_t view = 0; view < views_.size(); ++view) {
            add_features(problem, view);
            add_pins(problem, view, shape);
            add_curves(problem, view, points, shape);
        }
        for (std::size_t view = 1; view < views_.size(); ++view) add_motion(problem, view);
        add_priors(problem, shape);
        ceres::Solver::Options how;
        how.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
        how.max_num_iterations = shape ? 15 : 30;
        how.function_tolerance = 1e-5;
        how.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(how, &problem, &summary);
        estimate.iterations += static_cast<int>(summary.iterations.size());
        estimate.converged = summary.IsSolutionUsable();
        estimate.rms_ipd = rms(problem);
    }

    double rms(ceres::Problem& problem) const {
        // Residuals of features, pins and curves were added first; motion and priors follow
        std::vector<ceres::ResidualBlockId> blocks;
        problem.GetResidualBlocks(&blocks);
        double sum = 0;
        for (std::size_t i = 0; i < measured_.size(); ++i) {
            double cost = 0;
            problem.EvaluateResidualBlock(blocks[i], false, &cost, nullptr, nullptr);
            sum += 2 * cost * std::pow(measured_[i].sigma_px / measured_[i].ipd_px, 2);
        }
        return std::sqrt(sum / std::max<double>(1, static_cast<double>(measured_.size())));
    }

    /// Of a residual block.
    struct Measured {
        double sigma_px;
        double ipd_px;
    };

    const FaceModel& model_;
    const std::vector<FaceView>& views_;
    Camera camera_;
    FitOptions options_;
    State state_;
    fit::Blender blender_;
    std::vector<double> ipd_px_;  // of each view
    double robust_scale_ = 1;
    std::vector<Measured> measured_;
};

void check_view(const FaceModel& model, const FaceView& view) {
    const Feature* right = view.features.find("pupil.R");
    const Feature* left = view.features.find("pupil.L");
    require(right != nullptr && left != nullptr && (left->position - right->position).norm() >= 4,
            "features must hold pupil.R and pupil.L at least 4 pixels apart");
    for (const auto* named : {&view.features.features, &view.pins}) {
        for (const auto& feature : *named) {
            require(feature.position.allFinite() && feature.sigma_px > 0,
                    "feature " + feature.name + " must have a finite position and sigma_px above 0");
        }
    }
    for (const auto& motion : view.motion) {
        require(motion.point >= 0 && motion.point < model.points.rows() && motion.shift.allFinite() &&
                    motion.sigma_px > 0,
                "motion must name a point of the model, a finite shift and sigma_px above 0");
    }
    for (const auto& pin : view.pins) {
        require(landmark_index(model, pin.name) >= 0, "there is no landmark " + pin.name + " to pin");
    }
}

}  // namespace

void FitOptions::check() const {
    const auto positive = [](const char* name, double value) {
        require(std::isfinite(value) && value > 0,
                std::string(name) + " is " + std::to_string(value) + "; it must be above 0");
    };
    positive("focal_spread", focal_spread);
    positive("pitch_spread", pitch_spread);
    positive("yaw_spread", yaw_spread);
    positive("elsewhere", elsewhere);
    positive("robust_scale", robust_scale);
    positive("pupil_distance", pupil_distance);
    require(gaze_spread >= 0, "gaze_spread must not be negative");
    require(pose_free || shape_free, "poses or proportions must be free");
    require(max_rounds >= 1, "max_rounds is " + std::to_string(max_rounds) + "; it must be at least 1");
}

FaceEstimate fit_face(const FaceModel& model, const std::vector<FaceView>& views, const Camera& camera,
                      const FitOptions& options, const FaceEstimate* start) {
    model.check();
    camera.check();
    options.check();
    require(!views.empty(), "at least one view is needed");
    for (const auto& view : views) check_view(model, view);
    require(views[0].motion.empty(), "the first view has no motion: it is since that view");
    if (start != nullptr) {
        require(start->camera_from_head.size() == views.size() && start->focal > 0 &&
                    start->identity.size() == model.modes.rows() && start->identity.allFinite(),
                "the estimate to start from must be of the same views and the same model");
    }
    require(options.pose_free || start != nullptr,
            "poses that are kept are those of an estimate to start from");
    return FaceFitter(model, views, camera, options).run(start);
}

}  // namespace mimetic
