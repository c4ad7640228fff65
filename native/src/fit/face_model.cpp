// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/fit/fit.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>

#include "fit/blend.hpp"
#include "fit/outline.hpp"

namespace mimetic {
namespace {

using fit::landmark_at;
using fit::landmark_index;
using fit::with_focal;

constexpr int kJawStations = 33;
constexpr double kLobe = 0.2;  // rad below the horizontal

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

Points FaceModel::landmarks(VectorIn identity) const { return landmark_weights * shaped(identity); }

FaceFeatures project_features(const FaceModel& model, const FaceEstimate& estimate, const Camera& camera,
                              std::size_t view) {
    require(view < estimate.camera_from_head.size(), "the estimate has no such view");
    const Eigen::Isometry3d& camera_from_head = estimate.camera_from_head[view];
    const Camera actual = with_focal(camera, estimate.focal);
    const Points points = model.shaped(estimate.identity);
    FaceFeatures out;
    out.likelihood = 1;
    for (std::size_t i = 0; i < model.landmark_names.size(); ++i) {
        const Eigen::Vector3d in_head = landmark_at(model, points, static_cast<int>(i));
        out.features.push_back({model.landmark_names[i], actual.project(camera_from_head * in_head), 1, 1});
    }
    const auto as_curve = [](const std::string& name, Points2 line) {
        const auto count = line.rows();
        return FeatureCurve{name, std::move(line), Points2::Zero(count, 2), Eigen::VectorXd::Ones(count)};
    };
    for (std::size_t c = 0; c < model.curves.size(); ++c) {
        Points2 line(static_cast<int>(model.curves[c].size()), 2);
        for (int i = 0; i < line.rows(); ++i) {
            line.row(i) = actual.project(
                camera_from_head * points.row(model.curves[c][static_cast<std::size_t>(i)]).transpose());
        }
        out.curves.push_back(as_curve(model.curve_names[c], std::move(line)));
    }
    const Eigen::Vector2d left = out.find("pupil.L")->position;
    const Eigen::Vector2d right = out.find("pupil.R")->position;
    const Eigen::Vector2d across = left - right;
    // Half way between eyes and mouth; the jaw spans from below the ears' lobes, which would pass for it
    const Eigen::Vector2d center = (left + right) / 2 + 0.55 * Eigen::Vector2d(-across.y(), across.x());
    const double roll = std::atan2(across.y(), across.x());
    const auto edges = fit::outline(model, points, camera_from_head, actual);
    Points2 jaw = fit::jaw_line(edges, center, roll + kLobe, roll + M_PI - kLobe, kJawStations);
    if (jaw.rows() >= 5) out.curves.push_back(as_curve("jaw", std::move(jaw)));
    return out;
}

}  // namespace mimetic
