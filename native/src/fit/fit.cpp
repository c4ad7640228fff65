// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/error.hpp>
#include <mimetic/fit.hpp>

#include "fit/outline.hpp"
#include "fit/residuals.hpp"

namespace mimetic {
namespace {

using fit::EdgePoint;

constexpr double kIpdTolerance = 5e-5;  // metres
constexpr int kJawStations = 33;
constexpr double kLobe = 0.2;  // rad below the horizontal

/// A curve's stations lie closer than its errors are independent.
constexpr double kCurveInflation = 1.8;

/// What the solver moves.
struct State {
    Eigen::Matrix<double, fit::kPose, 1> pose;
    double log_focal = 0;
    Eigen::VectorXd identity;

    Eigen::Isometry3d camera_from_head() const {
        Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
        const double angle = pose.head<3>().norm();
        if (angle > 1e-12)
            transform.linear() = Eigen::AngleAxisd(angle, pose.head<3>() / angle).toRotationMatrix();
        transform.translation() = pose.tail<3>();
        return transform;
    }
};

Camera with_focal(Camera camera, double focal) {
    camera.fx = camera.fy = focal;
    return camera;
}

/// A weighted sum of points and of what the modes do to it.
struct Blend {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd modes;
};

Blend blend(const FaceModel& model, const std::vector<std::pair<int, double>>& weights) {
    Blend sum;
    sum.modes = Eigen::Matrix3Xd::Zero(3, model.modes.rows());
    for (const auto& [index, weight] : weights) {
        sum.mean += weight * model.points.row(index).transpose();
        sum.modes += weight * model.modes.middleCols<3>(3 * index).transpose();
    }
    return sum;
}

Blend landmark(const FaceModel& model, int index) {
    std::vector<std::pair<int, double>> weights;
    for (SparseRows::InnerIterator it(model.landmark_weights, index); it; ++it) {
        weights.emplace_back(static_cast<int>(it.col()), it.value());
    }
    return blend(model, weights);
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

/// Upright, facing the camera, where the pupils say.
State first_guess(const FaceModel& model, const FaceFeatures& features, const Camera& camera) {
    const Eigen::Vector2d right = features.find("pupil.R")->position;
    const Eigen::Vector2d left = features.find("pupil.L")->position;
    const Eigen::Vector3d eye_right = landmark_at(model, model.points, landmark_index(model, "pupil.R"));
    const Eigen::Vector3d eye_left = landmark_at(model, model.points, landmark_index(model, "pupil.L"));
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
    const Eigen::AngleAxisd turn(rotation);
    State state;
    state.pose << turn.angle() * turn.axis(), middle_in_camera - rotation * (eye_left + eye_right) / 2;
    state.log_focal = std::log(camera.fx);
    state.identity = Eigen::VectorXd::Zero(model.modes.rows());
    return state;
}

/// Points of a polyline of the model, one each half edge.
std::vector<EdgePoint> along(const std::vector<int>& chain, const Points& points,
                             const Eigen::Isometry3d& camera_from_head, const Camera& camera) {
    std::vector<EdgePoint> out;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        for (const double fraction : {0.0, 0.25, 0.5, 0.75}) {
            EdgePoint point{chain[i], chain[i + 1], fraction, {}, {}};
            const Eigen::Vector3d in_head =
                (1 - fraction) * points.row(chain[i]) + fraction * points.row(chain[i + 1]);
            point.pixel = camera.project(camera_from_head * in_head);
            out.push_back(point);
        }
    }
    return out;
}

/// The model point that a measured station of a curve belongs to, or nullptr.
const EdgePoint* partner(const std::vector<EdgePoint>& candidates, const Eigen::Vector2d& place,
                         const Eigen::Vector2d& normal, bool directed, double reach) {
    const EdgePoint* best = nullptr;
    double best_cost = reach * reach;
    const Eigen::Vector2d tangent(-normal.y(), normal.x());
    for (const auto& candidate : candidates) {
        if (directed && candidate.normal.dot(normal) < 0.4) continue;
        const Eigen::Vector2d off = candidate.pixel - place;
        const double across = off.dot(normal), beside = off.dot(tangent);
        // Along the curve a partner must be near; across it may be far at first
        const double cost = 0.3 * across * across + 9 * beside * beside;
        if (cost < best_cost) {
            best_cost = cost;
            best = &candidate;
        }
    }
    return best;
}

class FaceFitter {
public:
    FaceFitter(const FaceModel& model, const FaceFeatures& features, const Camera& camera,
               const FitOptions& options)
        : model_(model),
          features_(features),
          camera_(camera),
          options_(options),
          state_(first_guess(model, features, camera)) {
        ipd_px_ = (features.find("pupil.L")->position - features.find("pupil.R")->position).norm();
    }

    FaceEstimate run() {
        FaceEstimate estimate;
        // Pose alone first: proportions must not make up for a turned head. The loss starts wide, since a
        // feature that is far off only because the head is must not be given up.
        robust_scale_ = 8 * options_.robust_scale;
        solve(false, estimate);
        for (int round = 0; round < options_.max_rounds; ++round) {
            const State before = state_;
            robust_scale_ = std::max(1.0, std::exp2(3 - round)) * options_.robust_scale;
            solve(true, estimate);
            const double moved =
                (state_.pose - before.pose).norm() + 0.01 * (state_.identity - before.identity).norm();
            if (round >= 3 && moved < 2e-4) break;
        }
        estimate.camera_from_head = state_.camera_from_head();
        estimate.focal = std::exp(state_.log_focal);
        estimate.identity = state_.identity;
        return estimate;
    }

private:
    void add(ceres::Problem& problem, const Blend& point, const Eigen::Vector2d& observed,
             const Eigen::Matrix<double, Eigen::Dynamic, 2>& weight, double sigma_px) {
        auto* loss = new ceres::CauchyLoss(robust_scale_);
        problem.AddResidualBlock(new fit::ProjectionResidual(point.mean, point.modes, observed,
                                                             weight / sigma_px, {camera_.cx, camera_.cy}),
                                 loss, state_.pose.data(), &state_.log_focal, state_.identity.data());
        measured_.push_back(sigma_px);
    }

    void add_features(ceres::Problem& problem) {
        for (const auto& feature : features_.features) {
            const int index = landmark_index(model_, feature.name);
            // A curve of the same name says where across it, and claims nothing along it
            if (index < 0 || feature.likelihood < 0.05 || features_.find_curve(feature.name) != nullptr)
                continue;
            double sigma = feature.sigma_px;
            if (feature.name.starts_with("pupil.")) sigma = std::hypot(sigma, options_.gaze_spread * ipd_px_);
            add(problem, landmark(model_, index), feature.position, Eigen::Matrix2d::Identity(), sigma);
        }
    }

    void add_curves(ceres::Problem& problem, bool shape) {
        const Points points = model_.shaped(state_.identity);
        const Eigen::Isometry3d camera_from_head = state_.camera_from_head();
        const Camera camera = with_focal(camera_, std::exp(state_.log_focal));
        for (const auto& curve : features_.curves) {
            const bool is_jaw = curve.name == "jaw";
            if (is_jaw && !shape) continue;
            std::vector<EdgePoint> candidates;
            if (is_jaw) candidates = fit::outline(model_, points, camera_from_head, camera);
            for (std::size_t c = 0; c < model_.curve_names.size(); ++c) {
                if (model_.curve_names[c] == curve.name) {
                    candidates = along(model_.curves[c], points, camera_from_head, camera);
                }
            }
            for (int i = 0; i < curve.points.rows(); ++i) {
                const EdgePoint* match =
                    partner(candidates, curve.points.row(i), curve.normals.row(i), is_jaw, 0.35 * ipd_px_);
                if (match == nullptr) continue;
                add(problem,
                    blend(model_, {{match->first, 1 - match->fraction}, {match->second, match->fraction}}),
                    curve.points.row(i), curve.normals.row(i), kCurveInflation * curve.sigma_px(i));
            }
        }
    }

    void solve(bool shape, FaceEstimate& estimate) {
        ceres::Problem problem;
        measured_.clear();
        add_features(problem);
        add_curves(problem, shape);
        const Blend left = landmark(model_, landmark_index(model_, "pupil.L"));
        const Blend right = landmark(model_, landmark_index(model_, "pupil.R"));
        problem.AddResidualBlock(
            new fit::IdentityResidual(model_.spread, left.mean - right.mean, left.modes - right.modes,
                                      options_.pupil_distance, kIpdTolerance),
            nullptr, state_.identity.data());
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<fit::FacingResidual, 2, fit::kPose>(
                                     new fit::FacingResidual{options_.pitch_spread, options_.yaw_spread}),
                                 nullptr, state_.pose.data());
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
        ceres::Solver::Options how;
        how.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
        how.max_num_iterations = shape ? 15 : 30;
        how.function_tolerance = 1e-7;
        how.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(how, &problem, &summary);
        estimate.iterations += static_cast<int>(summary.iterations.size());
        estimate.converged = summary.IsSolutionUsable();
        estimate.rms_ipd = rms(problem);
    }

    double rms(ceres::Problem& problem) const {
        // The measured residuals were added first; priors follow
        std::vector<ceres::ResidualBlockId> blocks;
        problem.GetResidualBlocks(&blocks);
        double sum = 0;
        for (std::size_t i = 0; i < measured_.size(); ++i) {
            double cost = 0;
            problem.EvaluateResidualBlock(blocks[i], false, &cost, nullptr, nullptr);
            sum += 2 * cost * measured_[i] * measured_[i];
        }
        return std::sqrt(sum / std::max<double>(1, static_cast<double>(measured_.size()))) / ipd_px_;
    }

    const FaceModel& model_;
    const FaceFeatures& features_;
    Camera camera_;
    FitOptions options_;
    State state_;
    double ipd_px_ = 0;
    double robust_scale_ = 1;
    std::vector<double> measured_;  // standard deviations of the residual blocks, pixels
};

void require(bool holds, const std::string& text) {
    if (!holds) throw InvalidInput(text);
}

}  // namespace

void FaceModel::check() const {
    const auto num_points = points.rows();
    const auto num_modes = modes.rows();
    require(num_points > 0 && points.allFinite(), "model points must be finite and at least one");
    require(num_modes > 0 && modes.cols() == 3 * num_points && modes.allFinite(),
            "model modes must have the shape (identity, 3 x points) and be finite");
    require(spread.size() == num_modes && (spread.array() > 0).all(),
            "model spread must hold a value above 0 for each mode");
    require(limits.rows() == num_modes && limits.cols() == 2 && (limits.col(0).array() <= 0).all() &&
                (limits.col(1).array() >= 0).all(),
            "model limits must have the shape (identity, 2) and enclose 0");
    require(faces.size() == 0 || (faces.minCoeff() >= 0 && faces.maxCoeff() < num_points),
            "model faces must index its points");
    require(static_cast<Eigen::Index>(on_outline.size()) == num_points,
            "model on_outline must have one value a point");
    require(landmark_weights.rows() == static_cast<Eigen::Index>(landmark_names.size()) &&
                landmark_weights.cols() == num_points,
            "model landmark_weights must have the shape (landmarks, points)");
    require(landmark_index(*this, "pupil.L") >= 0 && landmark_index(*this, "pupil.R") >= 0,
            "model landmarks must hold pupil.L and pupil.R");
    require(curve_names.size() == curves.size(), "model curves must have a name each");
    for (const auto& curve : curves) {
        for (const int index : curve)
            require(index >= 0 && index < num_points, "model curves must index its points");
    }
}

Points FaceModel::shaped(VectorIn identity) const {
    const Eigen::RowVectorXd moved = identity.transpose() * modes;
    return points + Eigen::Map<const Points>(moved.data(), points.rows(), 3);
}

void FitOptions::check() const {
    const auto positive = [](const char* name, double value) {
        require(std::isfinite(value) && value > 0,
                std::string(name) + " is " + std::to_string(value) + "; it must be above 0");
    };
    positive("focal_spread", focal_spread);
    positive("pitch_spread", pitch_spread);
    positive("yaw_spread", yaw_spread);
    positive("robust_scale", robust_scale);
    positive("pupil_distance", pupil_distance);
    require(gaze_spread >= 0, "gaze_spread must not be negative");
    require(max_rounds >= 1, "max_rounds is " + std::to_string(max_rounds) + "; it must be at least 1");
}

FaceEstimate fit_face(const FaceModel& model, const FaceFeatures& features, const Camera& camera,
                      const FitOptions& options) {
    model.check();
    camera.check();
    options.check();
    const Feature* right = features.find("pupil.R");
    const Feature* left = features.find("pupil.L");
    require(right != nullptr && left != nullptr && (left->position - right->position).norm() >= 4,
            "features must hold pupil.R and pupil.L at least 4 pixels apart");
    for (const auto& feature : features.features) {
        require(feature.position.allFinite() && feature.sigma_px > 0,
                "feature " + feature.name + " must have a finite position and sigma_px above 0");
    }
    return FaceFitter(model, features, camera, options).run();
}

FaceFeatures project_features(const FaceModel& model, const FaceEstimate& estimate, const Camera& camera) {
    const Camera actual = with_focal(camera, estimate.focal);
    const Points points = model.shaped(estimate.identity);
    FaceFeatures out;
    out.likelihood = 1;
    for (std::size_t i = 0; i < model.landmark_names.size(); ++i) {
        const Eigen::Vector3d in_head = landmark_at(model, points, static_cast<int>(i));
        out.features.push_back(
            {model.landmark_names[i], actual.project(estimate.camera_from_head * in_head), 1, 1});
    }
    const auto as_curve = [](const std::string& name, Points2 line) {
        const auto count = line.rows();
        return FeatureCurve{name, std::move(line), Points2::Zero(count, 2), Eigen::VectorXd::Ones(count)};
    };
    for (std::size_t c = 0; c < model.curves.size(); ++c) {
        Points2 line(static_cast<int>(model.curves[c].size()), 2);
        for (int i = 0; i < line.rows(); ++i) {
            line.row(i) =
                actual.project(estimate.camera_from_head *
                               points.row(model.curves[c][static_cast<std::size_t>(i)]).transpose());
        }
        out.curves.push_back(as_curve(model.curve_names[c], std::move(line)));
    }
    const Eigen::Vector2d left = out.find("pupil.L")->position;
    const Eigen::Vector2d right = out.find("pupil.R")->position;
    const Eigen::Vector2d across = left - right;
    // Half way between eyes and mouth; the jaw spans from below the ears' lobes, which would pass for it
    const Eigen::Vector2d center = (left + right) / 2 + 0.55 * Eigen::Vector2d(-across.y(), across.x());
    const double roll = std::atan2(across.y(), across.x());
    const auto edges = fit::outline(model, points, estimate.camera_from_head, actual);
    Points2 jaw = fit::jaw_line(edges, center, roll + kLobe, roll + M_PI - kLobe, kJawStations);
    if (jaw.rows() >= 5) out.curves.push_back(as_curve("jaw", std::move(jaw)));
    return out;
}

}  // namespace mimetic
