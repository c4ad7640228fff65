// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_graph.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>
#include <string>
#include <utility>

#include "shared/robust.hpp"

namespace mimetic::head {
namespace {

constexpr double kLargestAngle = .75;  // rad between views that show enough of the same skin
constexpr std::size_t kMostPairs = 6;  // of one view with earlier ones
constexpr int kThinning = 2;           // of a registration's measurements
constexpr double kLeastScale = .7;
constexpr double kLeastCorrelation = .4;  // of views of one head
constexpr double kGrowth = .1;            // s.d. of the first fit's shape: logarithm,
constexpr double kTurn = .1;              // rad
constexpr double kShift = .01;            // and metres
constexpr double kTrust = .1;             // faces deform and shine: errors of neighbours are correlated
constexpr double kConditional = 1.5;      // depth errors estimated at poses that partly absorbed them
constexpr double kStartPatches = 3;       // patches that stand for the model's first depth error
constexpr double kLeastError = 1e-3;      // metres: no head is rigid
constexpr double kPatch = .025;           // metres: correlation length of a model's error
constexpr double kMostChange = .5;        // of a logarithm, radians, and tenths of a metre
constexpr int kSteps = 2;
constexpr int kPlacings = 3;     // times textures are matched on another model, from nearer and nearer
constexpr double kFixed = 1e12;  // information

using Rows6 = Eigen::Matrix<double, 2, 6>;

/// Of a view's pose among the unknowns.
Eigen::Index place_of(std::size_t view) { return static_cast<Eigen::Index>(kShapeSize + 6 * (view - 1)); }

/// How a point of the model moves by each entry of a change, head frame.
Eigen::Matrix<double, 3, kShapeSize> motion_by_change(const HeadShape& shape, const Eigen::Vector3d& point) {
    const Eigen::Vector3d arm = point - shape.centre;
    Eigen::Matrix<double, 3, kShapeSize> motion;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d direction = shape.turn.col(axis);
        motion.col(axis) = direction.dot(arm) * direction;
    }
    motion.middleCols<3>(3) = -cross_matrix(arm);
    motion.rightCols<3>().setIdentity();
    return motion;
}

ShapeChange prior_information(const HeadShape& shape, bool is_rigid) {
    ShapeChange information;
    information << Eigen::Vector3d::Constant(std::pow(kGrowth, -2)),
        Eigen::Vector3d::Constant(std::pow(kTurn, -2)), Eigen::Vector3d::Constant(std::pow(kShift, -2));
    if (is_rigid || shape.model == HeadModel::plane) {  // the patch stays what the paper compares with
        information.setConstant(kFixed);
    }
    return information;
}

}  // namespace

HeadShape changed(const HeadShape& shape, const ShapeChange& change) {
    HeadShape next = shape;
    const Eigen::Vector3d growth = change.head<3>().array().exp();
    const Eigen::Matrix3d turn = rotation_from_vector(change.segment<3>(3));
    const Eigen::Matrix3d grown = turn * shape.turn * growth.asDiagonal() * shape.turn.transpose();
    next.centre += change.tail<3>();
    if (shape.model == HeadModel::surface) {
        const Points arms = shape.vertices.rowwise() - shape.centre.transpose();
        next.vertices = (arms * grown.transpose()).rowwise() + next.centre.transpose();
    } else {
        next.half_axes = shape.half_axes.cwiseProduct(growth);
        next.turn = turn * shape.turn;
    }
    return next;
}

struct ViewGraph::Normal {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    explicit Normal(std::size_t num_views) {
        const Eigen::Index size = place_of(num_views);
        information.setZero(size, size);
        gradient.setZero(size);
    }
};

void ViewGraph::add(const HeadCrop& crop, const Eigen::Isometry3d& camera_from_head,
                    const Matrix6& covariance) {
    model_.views.emplace_back(model_.shape, options_, crop, camera_from_head, covariance);
    const std::vector<KeyView>& views = model_.views;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i + 1 < views.size(); ++i) {
        const double angle = angle_between(views[i].camera_from_head(), camera_from_head);
        if (angle < kLargestAngle) {
            order.emplace_back(angle, i);
        }
    }
    std::sort(order.begin(), order.end());
    order.resize(std::min(order.size(), kMostPairs));
    for (const auto& [angle, i] : order) {
        match(model_, i, views.size() - 1);
        match(model_, views.size() - 1, i);
    }
}

void ViewGraph::keep(std::size_t count) {
    if (count >= model_.views.size()) {
        return;
    }
    model_.views.erase(model_.views.begin() + static_cast<std::ptrdiff_t>(count), model_.views.end());
    std::erase_if(pairs_, [&](const Pair& pair) { return std::max(pair.from, pair.to) >= count; });
    for (int k = 0; k < 2 * kSteps; ++k) {
        step(model_, Free::all);  // the prior takes the shape back where no correspondence is left
    }
}

void ViewGraph::match(const Body& body, std::size_t from, std::size_t to) {
    const KeyView &first = body.views[from], &second = body.views[to];
    const Stabilised stabilised = first.stabilise(second.crop(), second.camera_from_head());
    if (stabilised.correlation < kLeastCorrelation || stabilised.in_sight < .2) {
        return;
    }
    HeadOptions options = options_;
    options.sample_spacing *= kThinning;
    std::vector<PointMeasurement> measurements;
    first.measure(body.shape, options, stabilised, 1, measurements);
    Pair pair{from, to, {}};
    for (const PointMeasurement& m : measurements) {
        const Eigen::Vector2d place =
            first.crop().camera.project(first.camera_from_head() * m.point).array() + .5;
        pair.matches.push_back(
            {static_cast<int>(place.x()), static_cast<int>(place.y()), m.pixel, m.weight * m.information});
    }
    pairs_.push_back(std::move(pair));
}

double ViewGraph::scale_of(const Body& body, const Pair& pair) const {
    const KeyView &first = body.views[pair.from], &second = body.views[pair.to];
    std::vector<double> distances;
    for (const Match& m : pair.matches) {
        if (first.shows(m.x, m.y)) {
            const Eigen::Vector3d place = second.camera_from_head() * first.point(m.x, m.y);
            const Eigen::Vector2d residual = m.pixel - second.crop().camera.project(place);
            distances.push_back(std::sqrt(residual.dot(m.information * residual)));
        }
    }
    return std::max(kLeastScale, upper_median(distances) / 1.18);
}

void ViewGraph::add_pair(const Body& body, const Pair& pair, Normal& normal) const {
    const KeyView &first = body.views[pair.from], &second = body.views[pair.to];
    const double scale = scale_of(body, pair);
    const Eigen::Isometry3d &from = first.camera_from_head(), &to = second.camera_from_head();
    const Eigen::Vector3d eye = from.inverse().translation();
    constexpr int kSize = kShapeSize + 12;
    Eigen::Matrix<double, kSize, kSize> information = Eigen::Matrix<double, kSize, kSize>::Zero();
    Eigen::Matrix<double, kSize, 1> gradient = Eigen::Matrix<double, kSize, 1>::Zero();
    for (const Match& m : pair.matches) {
        if (!first.shows(m.x, m.y)) {
            continue;
        }
        const Eigen::Vector3d point = first.point(m.x, m.y), normal_there = first.normal(m.x, m.y);
        const Eigen::Vector3d place = to * point;
        if (place.z() < .05) {
            continue;
        }
        const Eigen::Vector2d residual = m.pixel - second.crop().camera.project(place);
        const double x = std::sqrt(residual.dot(m.information * residual)) / (kTukeyCut * scale);
        if (x >= 1) {
            continue;
        }
        const double weight = kTrust * tukey_weight(x);
        // A pixel of the first view keeps its ray; where the model moves, its point slides along that.
        const Eigen::Vector3d ray = (point - eye).normalized();
        const Eigen::RowVector3d slide = normal_there.transpose() / normal_there.dot(ray);
        const Eigen::Matrix3d kept = ray * slide;
        const Eigen::Vector3d turned = from.linear() * point;
        Eigen::Matrix<double, 3, 6> by_from;  // of the model in the first camera, seen in the head frame
        by_from << -from.linear().transpose() * cross_matrix(turned), from.linear().transpose();
        Eigen::Matrix<double, 3, kSize> moved;
        moved.leftCols<kShapeSize>() = kept * motion_by_change(body.shape, point);
        moved.middleCols<6>(kShapeSize) = (kept - Eigen::Matrix3d::Identity()) * by_from;
        moved.leftCols<kShapeSize + 6>() = to.linear() * moved.leftCols<kShapeSize + 6>().eval();
        moved.rightCols<6>() << -cross_matrix(to.linear() * point), Eigen::Matrix3d::Identity();
        const Eigen::Matrix<double, 2, kSize> jacobian = second.crop().camera.project_jacobian(place) * moved;
        const Eigen::Matrix<double, kSize, 2> gain = weight * jacobian.transpose() * m.information;
        information += gain * jacobian;
        gradient += gain * residual;
    }
    struct Block {
        Eigen::Index here, there, size;
    };
    std::vector<Block> blocks{{0, 0, kShapeSize}};
    for (const auto& [view, here] : {std::pair{pair.from, kShapeSize}, {pair.to, kShapeSize + 6}}) {
        if (view > 0) {  // the first one is fixed
            blocks.push_back({here, place_of(view), 6});
        }
    }
    for (const Block& a : blocks) {
        normal.gradient.segment(a.there, a.size) += gradient.segment(a.here, a.size);
        for (const Block& b : blocks) {
            normal.information.block(a.there, b.there, a.size, b.size) +=
                information.block(a.here, b.here, a.size, b.size);
        }
    }
}

/// By how much patches of skin lie off the model, from where they are seen by other views.
double ViewGraph::depth_error(const Body& body) const {
    std::map<std::pair<int, int>, Eigen::Vector2d> patches;  // information, pull
    for (const Pair& pair : pairs_) {
        const KeyView &first = body.views[pair.from], &second = body.views[pair.to];
        const Eigen::Vector3d eye = first.camera_from_head().inverse().translation();
        const double scale = scale_of(body, pair);
        for (const Match& m : pair.matches) {
            if (!first.shows(m.x, m.y)) {
                continue;
            }
            const Eigen::Vector3d point = first.point(m.x, m.y);
            const Eigen::Vector3d place = second.camera_from_head() * point;
            const Eigen::Vector2d residual = m.pixel - second.crop().camera.project(place);
            const double x = std::sqrt(residual.dot(m.information * residual)) / (kTukeyCut * scale);
            if (x >= 1) {
                continue;
            }
            const Eigen::Vector2d shift = second.crop().camera.project_jacobian(place) *
                                          second.camera_from_head().linear() * (point - eye).normalized();
            const Eigen::Vector2d pull = tukey_weight(x) * m.information * shift;
            patches
                .try_emplace({static_cast<int>(std::floor(point.x() / kPatch)),
                              static_cast<int>(std::floor(point.y() / kPatch))},
                             Eigen::Vector2d::Zero())
                .first->second += Eigen::Vector2d(pull.dot(shift), pull.dot(residual));
        }
    }
    double sum = body.start_error * body.start_error * kStartPatches, num = kStartPatches;
    for (const auto& [place, patch] : patches) {
        constexpr double kClear = .002;  // metres
        if (patch[0] > std::pow(kClear, -2)) {
            sum += std::pow(patch[1] / patch[0], 2);
            num += 1;
        }
    }
    return std::max(kLeastError, kConditional * std::sqrt(sum / num));
}

ViewGraph::Normal ViewGraph::normal_equations(const Body& body, Free free) const {
    Normal normal(body.views.size());
    const bool is_rigid = free == Free::poses;
    const ShapeChange prior = prior_information(body.shape, is_rigid);
    normal.information.diagonal().array() += 1e-2;
    normal.information.diagonal().head<kShapeSize>() += prior;
    if (free == Free::shape) {
        normal.information.diagonal().tail(normal.gradient.size() - kShapeSize).array() += kFixed;
    }
    if (!is_rigid) {
        normal.gradient.head<kShapeSize>() -= prior.cwiseProduct(body.change);
    }
    for (const Pair& pair : pairs_) {
        add_pair(body, pair, normal);
    }
    return normal;
}

void ViewGraph::step(Body& body, Free free) {
    const Normal normal = normal_equations(body, free);
    const Eigen::LDLT<Eigen::MatrixXd> solver(normal.information);
    const Eigen::VectorXd change = solver.solve(normal.gradient);
    const ShapeChange of_shape = change.head<kShapeSize>();
    const ShapeChange total = body.change + of_shape;
    const bool is_head =
        total.head<6>().cwiseAbs().maxCoeff() < kMostChange && total.tail<3>().norm() < .1 * kMostChange;
    if (!change.allFinite() || !is_head) {
        if (free == Free::all) {
            step(body, Free::poses);
        }
        return;
    }
    const Eigen::MatrixXd spread = solver.solve(Eigen::MatrixXd::Identity(change.size(), change.size()));
    body.change = total;
    body.shape = changed(body.shape, of_shape);
    for (std::size_t k = 0; k < body.views.size(); ++k) {
        KeyView& view = body.views[k];
        Eigen::Isometry3d pose = view.camera_from_head();
        Matrix6 covariance = view.covariance();
        if (k > 0 && free != Free::shape) {
            const auto at = place_of(k);
            const Vector6 motion = change.segment<6>(at);
            pose.linear() = rotation_from_vector(motion.head<3>()) * pose.linear();
            pose.translation() += motion.tail<3>();
            covariance = spread.block<6, 6>(at, at);
        }
        view.move(body.shape, pose, covariance);
    }
}

void ViewGraph::match_anew(const Body& body) {
    for (const Pair& pair : std::exchange(pairs_, {})) {
        match(body, pair.from, pair.to);
    }
}

bool ViewGraph::relax(bool anew) {
    if (anew) {
        match_anew(model_);
    }
    if (pairs_.empty()) {
        return false;
    }
    for (int k = 0; k < (anew ? 2 : 1) * kSteps; ++k) {
        step(model_, Free::all);
    }
    model_.shape.depth_error = std::min(model_.start_error, depth_error(model_));
    return true;
}

std::vector<PlacedView> ViewGraph::place_on(const HeadShape& skin) {
    Body body{skin, skin.depth_error};
    for (const KeyView& view : model_.views) {
        body.views.emplace_back(skin, options_, view.crop(), view.camera_from_head(), view.covariance());
    }
    for (int round = 0; round < kPlacings && !pairs_.empty(); ++round) {
        if (round > 0) {
            match_anew(body);
        }
        for (int k = 0; k < 4 * kSteps; ++k) {
            step(body, Free::all);
        }
    }
    std::vector<PlacedView> placed;
    for (std::size_t k = 0; k < body.views.size() && !pairs_.empty(); ++k) {
        placed.push_back({model_.views[k].camera_from_head(), body.views[k].camera_from_head()});
    }
    return placed;
}

void ViewGraph::move_views(const std::vector<Eigen::Isometry3d>& poses) {
    if (poses.size() != model_.views.size()) {
        throw InvalidInput(std::to_string(poses.size()) + " poses for " +
                           std::to_string(model_.views.size()) + " reference textures");
    }
    for (std::size_t k = 0; k < poses.size(); ++k) {
        model_.views[k].move(model_.shape, poses[k], model_.views[k].covariance());
    }
    for (int k = 0; k < 2 * kSteps; ++k) {
        step(model_, Free::shape);
    }
}

}  // namespace mimetic::head
