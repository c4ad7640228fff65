// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/analyse/motion_scores.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/similarity.hpp>
#include <numbers>
#include <utility>

#include "shared/robust.hpp"

namespace mimetic {
namespace {

// Motion smaller than this, root mean square, is none.
constexpr double kLeastPx = .05;
constexpr double kLeast = 5e-5;  // m

/// A percentile of what is finite, between neighbours in proportion.
double percentile(std::vector<double> values, double percent) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    if (values.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return quantile(std::move(values), percent / 100);
}

void check_shapes(TracksIn tracks, SeenIn seen, TracksIn other, int dimensions) {
    if (tracks.rows() == 0 || tracks.rows() != seen.rows() || tracks.cols() != dimensions * seen.cols() ||
        other.rows() != tracks.rows() || other.cols() != tracks.cols()) {
        throw InvalidInput("tracks that are compared have different numbers of frames or points");
    }
}

/// All but the first frame.
Rows<std::uint8_t, Eigen::Dynamic> later(SeenIn seen) {
    Rows<std::uint8_t, Eigen::Dynamic> counted = seen;
    counted.row(0).setZero();
    return counted;
}

/// Lengths of what counts, point by point.
template <int Dimensions, typename Visit>
void visit_lengths(TracksIn vectors, SeenIn counted, Visit&& visit) {
    for (Eigen::Index i = 0; i < counted.rows(); ++i) {
        for (Eigen::Index k = 0; k < counted.cols(); ++k) {
            if (counted(i, k)) {
                visit(i, k, vectors.row(i).template segment<Dimensions>(Dimensions * k).norm());
            }
        }
    }
}

/// R2 about zero, 1 - sum |error|^2 / sum |motion|^2, over what counts; not a number if the motion's root
/// mean square is under `least`: nothing is there to be explained.
double explained_share(TracksIn error, TracksIn motion, SeenIn counted, int dimensions, double least) {
    double wrong = 0, whole = 0, count = 0;
    for (Eigen::Index i = 0; i < counted.rows(); ++i) {
        for (Eigen::Index k = 0; k < counted.cols(); ++k) {
            if (counted(i, k)) {
                wrong += error.row(i).segment(dimensions * k, dimensions).squaredNorm();
                whole += motion.row(i).segment(dimensions * k, dimensions).squaredNorm();
                ++count;
            }
        }
    }
    return whole <= least * least * count ? std::numeric_limits<double>::quiet_NaN() : 1 - wrong / whole;
}

}  // namespace

ImageScores score_image_motion(TracksIn tracks, TracksIn rigid, SeenIn seen, TracksIn predicted) {
    check_shapes(tracks, seen, predicted, 2);
    check_shapes(tracks, seen, rigid, 2);
    const auto counted = later(seen);
    const Tracks error = predicted - tracks, beyond = tracks - rigid;
    const Tracks moved = tracks.rowwise() - tracks.row(0);
    std::vector<double> distances, moving;
    double energy = 0;
    visit_lengths<2>(beyond, counted, [&](Eigen::Index i, Eigen::Index k, double apart) {
        const double distance = error.row(i).segment<2>(2 * k).norm();
        distances.push_back(distance);
        energy += apart * apart;
        if (apart > kMovingPx) {
            moving.push_back(distance);
        }
    });
    return {explained_share(error, moved, counted, 2, kLeastPx),
            explained_share(error, beyond, counted, 2, kLeastPx),
            percentile(distances, 50),
            percentile(distances, 95),
            percentile(moving, 50),
            std::sqrt(energy / static_cast<double>(distances.size()))};
}

SurfaceScores score_surface_motion(TracksIn points, SeenIn seen, TracksIn predicted) {
    check_shapes(points, seen, predicted, 3);
    const auto counted = later(seen);
    const Points first = Eigen::Map<const Points>(points.row(0).data(), seen.cols(), 3);
    const Points own = Eigen::Map<const Points>(predicted.row(0).data(), seen.cols(), 3);
    const Eigen::Matrix3d back = fit_similarity(own, first).rotation.transpose();
    const Tracks motion = points.rowwise() - points.row(0);
    Tracks error = predicted.rowwise() - predicted.row(0);
    for (Eigen::Index i = 0; i < error.rows(); ++i) {
        Eigen::Map<Points> row(error.row(i).data(), seen.cols(), 3);
        row = (row * back).eval();
    }
    error -= motion;
    std::vector<double> distances, moving, shape;
    visit_lengths<3>(motion, counted, [&](Eigen::Index i, Eigen::Index k, double moved) {
        const double distance = 1000 * error.row(i).segment<3>(3 * k).norm();
        distances.push_back(distance);
        if (moved > kMovingMetres) {
            moving.push_back(distance);
        }
    });
    const Points laid = (own.rowwise() - own.colwise().mean()) * back;
    const Points centred = first.rowwise() - first.colwise().mean();
    for (Eigen::Index k = 0; k < laid.rows(); ++k) {
        shape.push_back(1000 * (laid.row(k) - centred.row(k)).norm());
    }
    return {explained_share(error, motion, counted, 3, kLeast), percentile(distances, 50),
            percentile(moving, 50), percentile(shape, 50)};
}

Points head_turn_errors(const std::vector<Eigen::Isometry3d>& true_poses,
                        const std::vector<Eigen::Isometry3d>& poses) {
    if (poses.empty() || poses.size() != true_poses.size()) {
        throw InvalidInput("poses that are compared have different numbers of frames");
    }
    Points errors(poses.size(), 3);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Eigen::Matrix3d turned = poses[i].linear() * poses[0].linear().transpose();
        const Eigen::Matrix3d truly = true_poses[i].linear() * true_poses[0].linear().transpose();
        const Eigen::AngleAxisd error(Eigen::Matrix3d(turned * truly.transpose()));
        errors.row(static_cast<Eigen::Index>(i)) =
            180 / std::numbers::pi * error.angle() * error.axis().transpose();
    }
    return errors;
}

}  // namespace mimetic
