// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/rotations.hpp>
#include <mimetic/shared/scale.hpp>
#include <mimetic/solve/relief.hpp>
#include <opencv2/core/utility.hpp>

#include "error_field.hpp"
#include "seen_point.hpp"

namespace mimetic {

namespace {

/// Normal equations in the shape and the common shifts.
struct Normal {
    Eigen::MatrixXd information;
    Eigen::VectorXd pull;
};

/// Where the distinct points of all sightings are, and how they move: three rows a point, metres.
struct Seen {
    Eigen::VectorXd rest;          ///< 3P
    Points normals;                ///< P x 3, unit, outwards
    std::vector<bool> is_outline;  ///< P
    MatrixRows by_mode;            ///< 3P x M
    MatrixRows by_shape;  ///< 3P x (C + K + E): deeper by a component or bump, or by a shift common to
                          ///< all frames, of the texture or of the outline
};

Points normals_at(const FittedSkin& skin, const DistinctPoints& points) {
    Points normals(points.vertices.rows(), 3);
    for (Eigen::Index k = 0; k < normals.rows(); ++k) {
        Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
        for (int corner = 0; corner < 3; ++corner) {
            normal += points.barycentric(k, corner) * skin.normals.row(points.vertices(k, corner));
        }
        normals.row(k) = normal.normalized();
    }
    return normals;
}

/// Which of the distinct points are of an outline.
std::vector<bool> of_outline(const std::vector<Sighting>& sightings, const DistinctPoints& points) {
    std::vector<bool> are(static_cast<std::size_t>(points.vertices.rows()), false);
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        const std::vector<int>& index = points.index[i];
        for (std::size_t k = index.size() - static_cast<std::size_t>(sightings[i].num_outline);
             k < index.size(); ++k) {
            are[static_cast<std::size_t>(index[k])] = true;
        }
    }
    return are;
}

/// P x K: heights of bumps (K x S) at points.
MatrixRows heights_at(const FittedSkin& skin, const DistinctPoints& points, const MatrixRows& bumps) {
    MatrixRows heights = MatrixRows::Zero(points.vertices.rows(), bumps.rows());
    if (bumps.rows() == 0) {  // nor has it columns then
        return heights;
    }
    for (Eigen::Index k = 0; k < heights.rows(); ++k) {
        for (int corner = 0; corner < 3; ++corner) {
            for (SparseRows::InnerIterator entry(skin.stencils, points.vertices(k, corner)); entry; ++entry) {
                heights.row(k) +=
                    points.barycentric(k, corner) * entry.value() * bumps.col(entry.col()).transpose();
            }
        }
    }
    return heights;
}

Seen see(const FittedSkin& skin, const ReliefModel& model, const DistinctPoints& points,
         std::vector<bool> outline_points, const ReliefOptions& options) {
    const auto at = [&](MatrixIn modes) {
        return modes_at(skin.stencils, points.vertices, points.barycentric, modes);
    };
    const Eigen::Index count = points.vertices.rows();
    const Eigen::Index num_components = model.components.rows(), num_bumps = model.bumps.rows();
    const Eigen::Index num_shape = num_components + num_bumps;
    Seen seen{at(Eigen::Map<const MatrixRows>(skin.neutral.data(), 1, skin.neutral.size())).col(0),
              normals_at(skin, points), std::move(outline_points), at(model.modes), at(model.components)};
    const MatrixRows heights = heights_at(skin, points, model.bumps);
    std::vector<Eigen::Vector3d> places(static_cast<std::size_t>(count));
    for (Eigen::Index k = 0; k < count; ++k) {
        places[static_cast<std::size_t>(k)] = seen.rest.segment<3>(3 * k);
    }
    const ErrorField<double> field(places);
    const auto num_nodes = static_cast<Eigen::Index>(field.num_nodes());
    const Eigen::Matrix3d rotation = skin.reference_pose.linear();
    const Eigen::Vector3d camera_in_head = skin.camera_place();
    seen.by_shape.conservativeResize(Eigen::NoChange, num_shape + 4 * num_nodes);
    seen.by_shape.rightCols(num_bumps + 4 * num_nodes).setZero();
    for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Vector3d& place = places[static_cast<std::size_t>(k)];
        auto rows = seen.by_shape.middleRows<3>(3 * k);
        // Along the reference frame's ray, by as much as the component moves the surface across itself
        const Eigen::Vector3d ray = (place - camera_in_head).normalized();
        const double facing = std::min(seen.normals.row(k).dot(ray), -options.least_cosine);
        const Eigen::RowVectorXd outwards = seen.normals.row(k) * rows.leftCols(num_components);
        rows.leftCols(num_components) = ray * (outwards / facing);
        rows.middleCols(num_components, num_bumps) = ray * heights.row(k);
        const bool is_outline = seen.is_outline[static_cast<std::size_t>(k)];
        const double error = is_outline ? options.outline_error : options.lasting_error;
        const Eigen::Index first = num_shape + (is_outline ? 2 * num_nodes : 0);
        for (const auto& [node, height] : field.near(place)) {
            rows.col(first + node) = error * height * rotation.row(0).transpose();
            rows.col(first + num_nodes + node) = error * height * rotation.row(1).transpose();
        }
    }
    return seen;
}

/// Weight of each sighting: errors of those with similar head rotation are correlated.
std::vector<double> shares(const std::vector<Sighting>& sightings, double alike) {
    std::vector<double> counted;
    for (const Sighting& one : sightings) {
        double sum = 0;
        for (const Sighting& other : sightings) {
            const double angle = angle_between(one.camera_from_head, other.camera_from_head) / alike;
            sum += std::exp(-.5 * angle * angle);
        }
        counted.push_back(1 / sum);
    }
    return counted;
}

/// n x (C + K): depth of control vertices in the fitted frame, metres to the back, by each coefficient.
Eigen::MatrixXd depths_of(const FittedSkin& skin, const ReliefModel& model,
                          const std::vector<int>& vertices) {
    const Eigen::Index num_components = model.components.rows(), num_bumps = model.bumps.rows();
    const Eigen::RowVector3d backwards = skin.reference_pose.linear().row(2);
    const Points rays = skin.rays_to(vertices);
    Eigen::MatrixXd depths(static_cast<Eigen::Index>(vertices.size()), num_components + num_bumps);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const int vertex = vertices[i];
        auto row = depths.row(static_cast<Eigen::Index>(i));
        row.head(num_components) = backwards * model.components.middleCols<3>(3 * vertex).transpose();
        if (num_bumps > 0) {
            row.tail(num_bumps) =
                backwards.dot(rays.row(static_cast<Eigen::Index>(i))) * model.bumps.col(vertex).transpose();
        }
    }
    return depths;
}

/// (C + K) squared information about a change: the reference frame shows the head as it was fitted, and as
/// near. Bumps leave its picture as it is.
Eigen::MatrixXd held(const FittedSkin& skin, const ReliefModel& model, const ReliefOptions& options) {
    const Eigen::Isometry3d& pose = skin.reference_pose;
    const Eigen::Index num_components = model.components.rows();
    const Eigen::Index count = num_components + model.bumps.rows();
    const double pupils_px = kPupilDistance * skin.camera.fx / pose.translation().z();
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
    const auto hold = [&](const std::vector<int>& vertices, double std_px) {
        Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(vertices.size()), num_components);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Eigen::Vector3d place = skin.neutral.row(vertices[i]);
            rows.middleRows<2>(static_cast<Eigen::Index>(2 * i)) =
                SeenPoint(skin.camera, pose, place).by_point *
                model.components.middleCols<3>(3 * vertices[i]).transpose() / std_px;
        }
        information.topLeftCorner(num_components, num_components).noalias() += rows.transpose() * rows;
    };
    hold(model.landmarks, options.landmark_held * pupils_px);
    hold(model.spread, options.point_held * pupils_px);
    const Eigen::VectorXd deeper =
        depths_of(skin, model, model.spread).colwise().mean().transpose() / options.depth_held;
    return information + deeper * deeper.transpose();
}

/// 2K, for the rows of a frame's points: roots of the shares of their information that count.
Eigen::VectorXd heeded(const FittedSkin& skin, const Sighting& sighting, const std::vector<int>& index,
                       const Seen& seen, double grazing) {
    const Eigen::Vector3d then = skin.camera_place();
    const Eigen::Vector3d now = sighting.camera_from_head.inverse().translation();
    Eigen::VectorXd roots(2 * static_cast<Eigen::Index>(index.size()));
    for (std::size_t k = 0; k < index.size(); ++k) {
        const Eigen::Vector3d place = seen.rest.segment<3>(3 * static_cast<Eigen::Index>(index[k]));
        const Eigen::RowVector3d normal = seen.normals.row(index[k]);
        const double cosine =
            std::min(normal.dot((then - place).normalized()), normal.dot((now - place).normalized()));
        const bool is_outline = seen.is_outline[static_cast<std::size_t>(index[k])];
        const double share = is_outline ? 1 : std::clamp(cosine / grazing, 0., 1.);
        roots.segment<2>(static_cast<Eigen::Index>(2 * k)).setConstant(share * share);
    }
    return roots;
}

/// What one frame contributes, its own pose, values and model error eliminated.
Normal seen_in(const FittedSkin& skin, const ReliefModel& model, const ReliefOptions& options,
               const Sighting& sighting, const std::vector<int>& index, const Seen& seen) {
    std::vector<int> rows;
    for (const int point : index) {
        rows.insert(rows.end(), {3 * point, 3 * point + 1, 3 * point + 2});
    }
    const MatrixRows by_mode = seen.by_mode(rows, Eigen::all);
    const ModelError error{options.model_error, 0, kSightingError.motion};
    const WeighedSighting weighed = weigh(sighting, seen.rest(rows), by_mode, skin, error);
    const Eigen::VectorXd roots = heeded(skin, sighting, index, seen, options.grazing);
    const auto counted = roots.asDiagonal();
    const Eigen::VectorXd displacement = counted * weighed.displacement;
    const Eigen::MatrixXd shape = counted * weighed.in_picture(seen.by_shape(rows, Eigen::all));
    Eigen::MatrixXd own(shape.rows(), weighed.errors.cols() + by_mode.cols());
    own << counted * weighed.errors, counted * weighed.in_picture(by_mode) * model.std.asDiagonal();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(own.cols(), own.cols());
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(own.transpose());
    const Eigen::LLT<Eigen::MatrixXd> root(matrix);
    const Eigen::MatrixXd half = root.matrixL().solve(own.transpose() * shape);
    const Eigen::VectorXd half_pull = root.matrixL().solve(own.transpose() * displacement);
    Normal normal{Eigen::MatrixXd::Zero(shape.cols(), shape.cols()),
                  shape.transpose() * displacement - half.transpose() * half_pull};
    normal.information.selfadjointView<Eigen::Lower>().rankUpdate(shape.transpose());
    normal.information.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose(), -1);
    return normal;
}

void check(const FittedSkin& skin, const ReliefModel& model, const std::vector<Sighting>& sightings) {
    const Eigen::Index size = skin.neutral.size();
    const auto are_vertices = [&](const std::vector<int>& vertices) {
        return std::all_of(vertices.begin(), vertices.end(),
                           [&](int vertex) { return vertex >= 0 && vertex < skin.neutral.rows(); });
    };
    if (model.components.cols() != size || model.modes.cols() != size ||
        (model.bumps.rows() > 0 && model.bumps.cols() != skin.neutral.rows()) ||
        model.std.size() != model.modes.rows() || model.landmarks.empty() || model.spread.empty() ||
        !are_vertices(model.landmarks) || !are_vertices(model.spread) || !are_vertices(model.judged)) {
        throw InvalidInput("relief needs components, bumps, modes, landmarks and points of the skin's " +
                           std::to_string(skin.neutral.rows()) + " vertices, and one std a mode");
    }
    const Eigen::Index num_shape = model.components.rows() + model.bumps.rows();
    if (model.start.size() != 0 && (model.start.size() != num_shape || !model.start.allFinite())) {
        throw InvalidInput("relief starts from " + std::to_string(num_shape) + " finite coefficients");
    }
    for (const Sighting& sighting : sightings) {
        sighting.check();
    }
}

/// Standard deviations of depths beside the mean of others.
Eigen::VectorXd depth_std(const Eigen::MatrixXd& depths, const Eigen::MatrixXd& others,
                          const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd beside = depths.rowwise() - others.colwise().mean();
    return (beside * covariance).cwiseProduct(beside).rowwise().sum().cwiseMax(0).cwiseSqrt();
}

}  // namespace

Relief find_relief(const FittedSkin& skin, const ReliefModel& model, const std::vector<Sighting>& sightings,
                   const ReliefOptions& options, const Progress& progress) {
    check(skin, model, sightings);
    const DistinctPoints points = distinct_points(sightings);
    const Seen seen = see(skin, model, points, of_outline(sightings, points), options);
    const std::vector<double> share = shares(sightings, options.alike);
    const Eigen::Index size = seen.by_shape.cols();
    const Eigen::Index num_shape = model.components.rows() + model.bumps.rows();
    Eigen::VectorXd start = Eigen::VectorXd::Zero(size);
    if (model.start.size() > 0) {
        start.head(num_shape) = model.start;
    }
    Normal all{Eigen::MatrixXd::Identity(size, size), -start};
    all.information.topLeftCorner(num_shape, num_shape) += held(skin, model, options);
    constexpr std::size_t kTogether = 8;
    for (std::size_t first = 0; first < sightings.size(); first += kTogether) {
        if (progress && !progress(static_cast<double>(first) / static_cast<double>(sightings.size()))) {
            return {};
        }
        std::vector<Normal> parts(std::min(kTogether, sightings.size() - first));
        cv::parallel_for_({0, static_cast<int>(parts.size())}, [&](const cv::Range& range) {
            for (auto i = static_cast<std::size_t>(range.start); i < static_cast<std::size_t>(range.end);
                 ++i) {
                parts[i] = seen_in(skin, model, options, sightings[first + i], points.index[first + i], seen);
            }
        });
        for (std::size_t i = 0; i < parts.size(); ++i) {
            all.information.triangularView<Eigen::Lower>() += share[first + i] * parts[i].information;
            all.pull += share[first + i] * parts[i].pull;
        }
    }
    const Eigen::LLT<Eigen::MatrixXd> root = all.information.selfadjointView<Eigen::Lower>().llt();
    const Eigen::VectorXd shape = start + root.solve(all.pull);
    const Eigen::MatrixXd covariance = root.solve(Eigen::MatrixXd::Identity(size, num_shape));
    return {shape.head(num_shape),
            depth_std(depths_of(skin, model, model.judged), depths_of(skin, model, model.spread),
                      covariance.topRows(num_shape))};
}

}  // namespace mimetic
