// SPDX-License-Identifier: GPL-3.0-or-later
#include "registration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/shared/rotations.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/bilinear.hpp"
#include "shared/robust.hpp"

namespace mimetic::head {
namespace {

constexpr float kBare = .06F;     // of a value's square, that noise alone reaches
constexpr float kLeastPatch = 5;  // samples of a patch that is tested for occlusion
constexpr float kAlike = .5F;     // correlation from which a patch shows the same skin
constexpr double kShared = 2;     // samples that share one error
constexpr double kMaxTurn = .3;   // rad a step
// s.d. of a head's motion from its predicted pose: separates rotation and translation where a coarse level
// does not
constexpr std::array<double, kLevels> kPriorRotation{1, .15, .1};       // rad
constexpr std::array<double, kLevels> kPriorTranslation{.3, .05, .03};  // metres

using Matrix6f = Eigen::Matrix<float, 6, 6>;
using Vector6f = Eigen::Matrix<float, 6, 1>;

/// The part of a frame's level that shows the head.
struct PlainLevel {
    Camera camera;
    cv::Mat1f image;
    std::size_t index = 0;
};

/// What the frame shows at the samples of one view.
struct Compared {
    const Samples* samples = nullptr;
    float share = 0;
    Eigen::VectorXf values;    // of the frame
    Eigen::VectorXf in_sight;  // the samples' own weights; 0: not visible
    Eigen::VectorXf weights;   // those times the robust weights over the variance; 0: occluded, outlier
    Eigen::VectorXf alike;     // correlation by patch
};

/// Pixels of samples; x below 0: not visible.
struct Pixels {
    Eigen::VectorXf x, y;
};

Pixels project(const Samples& samples, const Camera& camera, const Eigen::Isometry3d& pose,
               const HeadOptions& options) {
    constexpr float kPast = .8F;  // skin turned away slightly further still counts as visible
    const float least_facing = kPast * static_cast<float>(options.least_facing);
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    const Eigen::Vector3f shift = pose.translation().cast<float>();
    const PointRows points = (turn * samples.points).colwise() + shift;
    const PointRows normals = turn * samples.normals;
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
    const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
    const auto right = static_cast<float>(camera.width - 1), low = static_cast<float>(camera.height - 1);
    Pixels pixels{Eigen::VectorXf(samples.size()), Eigen::VectorXf(samples.size())};
    for (Eigen::Index k = 0; k < samples.size(); ++k) {
        const float x = points(0, k), y = points(1, k), z = points(2, k);
        const float u = fx * x / z + cx, v = fy * y / z + cy;
        const float towards = -(normals(0, k) * x + normals(1, k) * y + normals(2, k) * z);
        const bool seen = z > 0 && towards > 0 && u >= 0 && v >= 0 && u < right && v < low &&
                          towards * towards >= least_facing * least_facing * (x * x + y * y + z * z);
        pixels.x[k] = seen ? u : -1;
        pixels.y[k] = v;
    }
    return pixels;
}

/// Where samples of the views are seen, and the pixels between them.
PlainLevel see_level(const ViewShares& views, const Pyramid& now, std::size_t level,
                     const Eigen::Isometry3d& pose, const HeadOptions& options) {
    const PyramidLevel& seen = now[level];
    cv::Mat1f mask = cv::Mat1f::zeros(seen.gray.size());
    for (const auto& [share, view] : views) {
        const Pixels pixels = project(view->samples(level), seen.camera, pose, options);
        for (Eigen::Index k = 0; k < pixels.x.size(); ++k) {
            if (pixels.x[k] >= 0) {
                mask(static_cast<int>(pixels.y[k] + .5F), static_cast<int>(pixels.x[k] + .5F)) = 1;
            }
        }
    }
    const int reach = std::max(3, 2 * sample_spacing(options, level) - 1);
    cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {reach, reach}));
    return {seen.camera, normalised(seen.gray, mask, level), level};
}

void fetch(const PlainLevel& level, const Eigen::Isometry3d& pose, const HeadOptions& options,
           Compared& view) {
    const Samples& samples = *view.samples;
    const Pixels pixels = project(samples, level.camera, pose, options);
    view.values.resize(samples.size());
    view.in_sight.resize(samples.size());
    for (Eigen::Index k = 0; k < samples.size(); ++k) {
        const bool seen = pixels.x[k] >= 0;
        view.values[k] = seen ? bilinear(level.image, pixels.x[k], pixels.y[k]) : 0;
        view.in_sight[k] = seen ? samples.weights[k] : 0;
    }
}

/// Patches that differ from the reference are occluded or moved non-rigidly.
void weigh_patches(Compared& view) {
    const Samples& samples = *view.samples;
    Eigen::Array4Xf sums = Eigen::Array4Xf::Zero(4, samples.num_patches);
    for (Eigen::Index k = 0; k < samples.size(); ++k) {
        if (view.in_sight[k] > 0) {
            const float from = samples.values[k], to = view.values[k];
            sums.col(samples.patches[static_cast<std::size_t>(k)]) +=
                Eigen::Array4f(1, from * to, from * from, to * to);
        }
    }
    const Eigen::ArrayXf bare = kBare * sums.row(0);
    view.alike = (sums.row(1).transpose() + bare) /
                 ((sums.row(2).transpose() + bare) * (sums.row(3).transpose() + bare)).max(1e-6F).sqrt();
    view.weights = view.in_sight;
    for (Eigen::Index k = 0; k < samples.size(); ++k) {
        const int patch = samples.patches[static_cast<std::size_t>(k)];
        const float alike = sums(0, patch) < kLeastPatch ? kAlike : std::max(0.F, view.alike[patch]);
        view.weights[k] *= std::min(1.F, alike / kAlike);
    }
}

float scale_of(const std::vector<Compared>& views) {
    std::vector<float> distances;
    for (const Compared& view : views) {
        for (Eigen::Index k = 0; k < view.values.size(); ++k) {
            if (view.weights[k] > 0) {
                distances.push_back(std::abs(view.values[k] - view.samples->values[k]) /
                                    view.samples->spread[k]);
            }
        }
    }
    return distances.empty() ? 1 : std::max(.3F, 1.48F * upper_median(distances));
}

void weigh_residuals(float scale, Compared& view) {
    const Eigen::ArrayXf spread = scale * view.samples->spread.array();
    const Eigen::ArrayXf x =
        (view.values - view.samples->values).array() / (static_cast<float>(kTukeyCut) * spread);
    view.weights.array() *= (1 - x.square()).max(0).square() / spread.square();
}

/// The motion in the head's own frame from one pose to another: rotation vector, shift.
Vector6 motion_between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
    const Eigen::Isometry3d motion = from.inverse() * to;
    Vector6 step;
    step << rotation_vector(motion.linear()), motion.translation();
    return step;
}

struct Normal {
    Matrix6 information = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
};

Normal normal_equations(const std::vector<Compared>& views, const Vector6& off, std::size_t level) {
    Normal normal;
    normal.information.diagonal().head<3>().setConstant(std::pow(kPriorRotation[level], -2));
    normal.information.diagonal().tail<3>().setConstant(std::pow(kPriorTranslation[level], -2));
    normal.gradient = normal.information * off;
    constexpr double precision = 1 / kShared;
    for (const Compared& view : views) {
        const auto& jacobian = view.samples->jacobian;
        const Eigen::Matrix<float, 6, Eigen::Dynamic> weighted =
            view.share * (jacobian.array().rowwise() * view.weights.transpose().array()).matrix();
        normal.information += precision * (weighted * jacobian.transpose()).cast<double>();
        normal.gradient += precision * (weighted * (view.values - view.samples->values)).cast<double>();
    }
    return normal;
}

Eigen::Isometry3d motion_of(const Vector6& step) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = rotation_from_vector(step.head<3>(), kMaxTurn);
    motion.translation() = step.tail<3>();
    return motion;
}

std::vector<Compared> compare(const ViewShares& views, const PlainLevel& now, const Eigen::Isometry3d& pose,
                              const HeadOptions& options) {
    std::vector<Compared> compared;
    for (const auto& [share, view] : views) {
        compared.push_back({&view->samples(now.index), static_cast<float>(share), {}, {}, {}, {}});
        fetch(now, pose, options, compared.back());
        weigh_patches(compared.back());
    }
    return compared;
}

PlainLevel solve_level(const ViewShares& views, const Pyramid& pyramid, std::size_t level,
                       const Eigen::Isometry3d& expected, const HeadOptions& options,
                       Eigen::Isometry3d& pose) {
    PlainLevel now = see_level(views, pyramid, level, pose, options);
    constexpr double kStill = .02;  // pixels of the level
    for (int round = 0; round < options.max_iterations + 2 * static_cast<int>(level); ++round) {
        auto compared = compare(views, now, pose, options);
        const float scale = scale_of(compared);
        for (Compared& view : compared) {
            weigh_residuals(scale, view);
        }
        const Normal normal = normal_equations(compared, motion_between(expected, pose), level);
        const Vector6 step = normal.information.llt().solve(normal.gradient);
        if (!step.allFinite()) {
            break;
        }
        pose = pose * motion_of(step).inverse();
        const double moved = .1 * step.head<3>().norm() + step.tail<3>().norm();
        if (moved * now.camera.fy < kStill * pose.translation().norm()) {
            break;
        }
    }
    return now;
}

/// How the samples of the finest levels fit, without robust weights on single samples.
void judge(const std::vector<Compared>& views, Registration& found) {
    double both = 0, from = 0, to = 0, in_sight = 0, all = 0, alike = 0;
    for (const Compared& view : views) {
        const Samples& samples = *view.samples;
        for (Eigen::Index k = 0; k < samples.size(); ++k) {
            all += view.share * samples.weights[k];
            const double weight = view.share * view.in_sight[k];
            if (weight <= 0) {
                continue;
            }
            const double a = samples.values[k], b = view.values[k];
            both += weight * a * b;
            from += weight * a * a;
            to += weight * b * b;
            in_sight += weight;
            alike += weight * (view.alike[samples.patches[static_cast<std::size_t>(k)]] > kAlike);
            ++found.num_samples;
        }
    }
    found.correlation = from > 0 && to > 0 ? both / std::sqrt(from * to) : 0;
    found.in_sight = all > 0 ? in_sight / all : 0;
    found.explained = in_sight > 0 ? alike / in_sight : 0;
}

/// Noise of the samples, and what an error of the model, one over each patch of skin, does to the pose.
void add_covariance(const std::vector<Compared>& views, const PlainLevel& now, Registration& found) {
    const Normal normal = normal_equations(views, Vector6::Zero(), now.index);
    const Matrix6 inverse = normal.information.llt().solve(Matrix6::Identity());
    constexpr double precision = 1 / kShared;
    Matrix6 spread = Matrix6::Zero();
    double sum = 0, weights = 0;
    for (const Compared& view : views) {
        const Samples& samples = *view.samples;
        Eigen::Matrix<double, 6, Eigen::Dynamic> pulls =
            Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, samples.num_patches);
        for (Eigen::Index k = 0; k < samples.size(); ++k) {
            const double weight = view.share * view.weights[k];
            if (weight <= 0) {
                continue;
            }
            const Eigen::Vector3d point = found.camera_from_head * samples.points.col(k).cast<double>();
            const Eigen::Vector2d shift = now.camera.project_jacobian(point) *
                                          found.camera_from_head.linear() *
                                          samples.depth_error.col(k).cast<double>();
            const Eigen::Vector2d gradient = samples.gradients.col(k).cast<double>();
            pulls.col(samples.patches[static_cast<std::size_t>(k)]) +=
                weight * precision * gradient.dot(shift) * samples.jacobian.col(k).cast<double>();
            sum += weight * std::pow(view.values[k] - samples.values[k], 2);
            weights += weight * gradient.squaredNorm();
        }
        spread += pulls * pulls.transpose();
    }
    Matrix6 turned = Matrix6::Zero();  // from the head's axes to the camera's
    turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = found.camera_from_head.linear();
    const Matrix6 covariance = turned * (inverse + inverse * spread * inverse) * turned.transpose();
    found.covariance = .5 * (covariance + covariance.transpose());
    found.residual_px = weights > 0 ? std::sqrt(sum / weights) : 0;
}

}  // namespace

Registration register_coarsely(const ViewShares& views, const Pyramid& now, const Eigen::Isometry3d& start,
                               const HeadOptions& options) {
    Registration found;
    found.camera_from_head = start;
    const PlainLevel seen = solve_level(views, now, kLevels - 1, start, options, found.camera_from_head);
    judge(compare(views, seen, found.camera_from_head, options), found);
    return found;
}

Registration register_views(const ViewShares& views, const Pyramid& now, const Eigen::Isometry3d& start,
                            const HeadOptions& options) {
    Registration found;
    found.camera_from_head = start;
    std::array<PlainLevel, kLevels> seen;
    for (std::size_t level = kLevels; level-- > 0;) {
        seen[level] = solve_level(views, now, level, start, options, found.camera_from_head);
    }
    // The second level has half the noise, and so discriminates better whether this is the head.
    judge(compare(views, seen[1], found.camera_from_head, options), found);
    auto compared = compare(views, seen[0], found.camera_from_head, options);
    const float scale = scale_of(compared);
    for (Compared& view : compared) {
        weigh_residuals(scale, view);
    }
    add_covariance(compared, seen[0], found);
    return found;
}

}  // namespace mimetic::head
