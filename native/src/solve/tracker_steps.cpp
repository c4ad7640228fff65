// SPDX-License-Identifier: GPL-3.0-or-later
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "motion_prior.hpp"
#include "tracker_state.hpp"

namespace mimetic {

namespace {

constexpr double kRotationStd = .1;      // rad a frame beyond the prediction
constexpr double kDeadZone = 2;          // more would delay onsets
constexpr double kTranslationStd = .02;  // metres a frame
constexpr int kRelativeHeight = 110;     // pixels of the face for the frame-to-frame flow
constexpr double kFarthest = .008;       // metres from the model at which skin is still explained
constexpr double kExplained = .5;        // correlation of a patch that is the same skin

double ratio_or_zero(double part, double whole) { return whole > 0 ? part / whole : 0; }

}  // namespace

StepPrior FaceTracker::State::at_state(const StepPrior& prior) const {
    StepPrior here{prior.information, prior.information * predicted.difference_from(state)};
    const RestPull::Terms terms =
        to_rest.at(state.values, state.values, to_rest.shown(state.values), last_std, kDeadZone);
    here.information.bottomRightCorner(num_values(), num_values()) += rest_pull;
    here.gradient.tail(num_values()) -= rest_pull * state.values;
    here.information.diagonal().tail(num_values()) += terms.information;
    here.gradient.tail(num_values()) += terms.pull;
    return here;
}

double FaceTracker::State::face_pixels_per_crop_pixel() const {
    const ReferenceView& view = *views.front();
    const double nearer =
        view.camera_from_head().translation().z() / state.camera_from_head.translation().z();
    return nearer / view.scale();
}

double FaceTracker::State::view_angle(const ReferenceView& view) const {
    const auto towards_camera = [](const Eigen::Isometry3d& pose) -> Eigen::Vector3d {
        return -(pose.linear().transpose() * pose.translation()).normalized();
    };
    const double cosine = towards_camera(view.camera_from_head()).dot(towards_camera(state.camera_from_head));
    return std::acos(std::clamp(cosine, -1., 1.));
}

StepPrior FaceTracker::State::predict() {
    const Eigen::Index size = 6 + num_values();
    const double memory = std::exp(-1 / options.correlation_time);
    constexpr double kDamping = .6;
    predicted = last;
    predicted.apply(kDamping * velocity);
    predicted.values = predicted.values.cwiseMax(motion.lower).cwiseMin(motion.upper);
    Eigen::VectorXd fade = Eigen::VectorXd::Constant(size, memory);
    fade.head<6>().setOnes();
    Eigen::VectorXd noise_variance = Eigen::VectorXd::Zero(size);
    noise_variance.head<3>().setConstant(kRotationStd * kRotationStd);
    noise_variance.segment<3>(3).setConstant(kTranslationStd * kTranslationStd);
    covariance = fade.asDiagonal() * covariance * fade.asDiagonal();
    covariance.diagonal() += noise_variance;
    covariance.bottomRightCorner(num_values(), num_values()) += (1 - memory * memory) * rest;
    state = predicted;
    StepPrior prior;
    prior.information = covariance.llt().solve(Eigen::MatrixXd::Identity(size, size));
    prior.gradient = Eigen::VectorXd::Zero(size);
    return prior;
}

void FaceTracker::State::follow_flow(const StepPrior& prior) {
    // The whole face's motion from frame to frame, wherever the textures would not reach.
    projected.update(surface, camera, last.camera_from_head, last.values);
    Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9f), high = -low;
    for (const ReferenceSample& sample : views.front()->samples()) {
        const Eigen::Vector2f pixel = projected.pixels.row(surface.triangles()(sample.triangle, 0));
        low = low.cwiseMin(pixel);
        high = high.cwiseMax(pixel);
    }
    const Eigen::Vector2f margin = .5f * (high - low);
    const cv::Rect box = cv::Rect(cv::Point2f(low.x() - margin.x(), low.y() - margin.y()),
                                  cv::Point2f(high.x() + margin.x(), high.y() + margin.y())) &
                         cv::Rect(0, 0, gray.cols, gray.rows);
    if (box.width < 32 || box.height < 32) {
        return;
    }
    const double scale = std::min(1., kRelativeHeight / static_cast<double>(high.y() - low.y()));
    cv::Mat1b before, after;
    cv::resize(last_gray(box), before, cv::Size(), scale, scale, cv::INTER_AREA);
    cv::resize(gray(box), after, cv::Size(), scale, scale, cv::INTER_AREA);
    if (std::min(before.rows, before.cols) < 24) {
        return;
    }
    cv::Mat2f flow;
    relative_dis->calc(before, after, flow);
    measurements.clear();
    const Eigen::Index stride = 1 + static_cast<Eigen::Index>(views.front()->samples().size()) / 500;
    for (std::size_t k = 0; k < views.front()->samples().size(); k += static_cast<std::size_t>(stride)) {
        const ReferenceSample& sample = views.front()->samples()[k];
        Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
        for (int corner = 0; corner < 3; ++corner) {
            pixel += sample.barycentric[corner] *
                     projected.pixels.row(surface.triangles()(sample.triangle, corner)).transpose();
        }
        const int x = static_cast<int>(std::lround((pixel.x() - static_cast<float>(box.x)) * scale));
        const int y = static_cast<int>(std::lround((pixel.y() - static_cast<float>(box.y)) * scale));
        if (x < 0 || y < 0 || x >= flow.cols || y >= flow.rows) {
            continue;
        }
        SampleMeasurement measurement;
        measurement.sample = &sample;
        measurement.displacement = Eigen::Vector2d(flow(y, x)[0], flow(y, x)[1]) / scale;
        measurement.covariance = Eigen::Matrix2d::Identity() * std::pow(.5 / scale, 2);
        measurement.correlation = 1;
        measurement.weight = sample.weight;
        measurements.push_back(measurement);
    }
    state = last;
    NoiseModel wide = noise;
    wide.robust_cut = 8;
    wide.samples_a_window = 10;
    relative_solver->linearise(camera, state, measurements, wide);
    state.apply(relative_solver->solve(at_state(prior), state, 6 + num_values(), 2));
}

std::vector<std::size_t> FaceTracker::State::choose_views() const {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < views.size(); ++k) {
        if (view_angle(*views[k]) < view_angle(*views[nearest])) {
            nearest = k;
        }
    }
    constexpr double kWorthIt = .1;  // rad by which a key view must be nearer than the first
    if (nearest == 0 || view_angle(*views[0]) - view_angle(*views[nearest]) < kWorthIt) {
        return {0};
    }
    return {0, nearest};
}

void FaceTracker::State::find_visible(const ReferenceView& view, std::vector<float>& out) const {
    const Eigen::Vector3f eye = (state.camera_from_head.inverse().translation()).cast<float>();
    out.resize(view.samples().size());
    for (std::size_t k = 0; k < out.size(); ++k) {
        const ReferenceSample& sample = view.samples()[k];
        const auto corners = surface.triangles().row(sample.triangle);
        const Eigen::Vector3f first = projected.points_in_head.row(corners[0]);
        const Eigen::Vector3f normal =
            (projected.points_in_head.row(corners[1]).transpose() - first)
                .cross(projected.points_in_head.row(corners[2]).transpose() - first)
                .normalized();
        constexpr float kGrazing = .2f;
        const float frontality = normal.dot((eye - first).normalized());
        out[k] = std::clamp((frontality - kGrazing) / .3f, 0.f, 1.f);
        const Eigen::Vector2f pixel = projected.pixels.row(corners[0]);
        if (pixel.x() < 1 || pixel.y() < 1 || pixel.x() > static_cast<float>(gray.cols - 2) ||
            pixel.y() > static_cast<float>(gray.rows - 2)) {
            out[k] = 0;
            continue;
        }
        const Eigen::Vector2d cell = (pixel.cast<double>() - grid.origin) * grid.scale;
        const int x = static_cast<int>(std::lround(cell.x())), y = static_cast<int>(std::lround(cell.y()));
        if (x >= 0 && y >= 0 && x < raster.cols && y < raster.rows) {
            constexpr float kBehind = .012f;  // metres: thicker than a raster cell's slope
            if (projected.depths[corners[0]] > raster.depth[raster.index(x, y)] + kBehind) {
                out[k] = 0;
            }
        }
    }
}

void FaceTracker::State::raster_hypothesis() {
    constexpr int kRasterHeight = 80;
    const double face_height = face_pixels_per_crop_pixel() * options.crop_height;
    const Eigen::Vector2d head = camera.project(state.camera_from_head.translation());
    grid.scale = std::min(1., kRasterHeight / face_height);
    grid.origin = head - Eigen::Vector2d::Constant(1.2 * face_height);
    grid.rows = grid.cols = static_cast<int>(2.4 * face_height * grid.scale);
    raster_surface(projected, surface.triangles(), grid, raster);
}

void FaceTracker::State::measure(bool is_first, bool is_last, FrameScore& score) {
    measurements.clear();
    {
        const StageClock clock(times.warp_ms);
        projected.update(surface, camera, state.camera_from_head, state.values);
        if (is_first) {
            raster_hypothesis();  // what hides what hardly changes with the steps that follow
        }
    }
    const std::vector<std::size_t> chosen = choose_views();
    score.num_views = static_cast<int>(chosen.size());
    score.num_samples = 0;
    for (const std::size_t index : chosen) {
        ReferenceView& view = *views[index];
        {
            const StageClock clock(times.warp_ms);
            find_visible(view, visible);
            view.stabilise(surface.triangles(), projected, frame, map, stabilised);
        }
        const StageClock clock(times.flow_ms);
        texture_flow.measure(view, map, stabilised, visible, std::sin(std::min(1.5, view_angle(view))),
                             is_first && !is_last, measurements);
    }
    score.num_samples = static_cast<int>(measurements.size());
    for (SampleMeasurement& measurement : measurements) {
        measurement.weight = unlike.contains(measurement.sample) ? 0 : measurement.weight;
    }
    // Textures of the same skin share the model's error: two of them know no more than one.
    for (SampleMeasurement& measurement : measurements) {
        measurement.weight /= static_cast<float>(chosen.size());
    }
}

FrameScore FaceTracker::State::register_textures(const StepPrior& prior, int num_iterations,
                                                 Eigen::Index num_free) {
    FrameScore score;
    const ReferenceView& first = *views.front();
    for (int iteration = 0; iteration < num_iterations; ++iteration) {
        if (!(state.camera_from_head.translation().z() > .02)) {
            return {};
        }
        measure(iteration == 0, iteration + 1 == num_iterations, score);
        if (measurements.size() < 30) {
            return {};
        }
        const StageClock clock(times.solve_ms);
        NoiseModel present = noise;
        present.robust_cut *= iteration == 0 ? 2.5 : 1;  // far off at first
        solver->linearise(camera, state, measurements, present);
        const Eigen::VectorXd step = solver->solve(at_state(prior), state, num_free, iteration == 0 ? 3 : 2);
        last_step = step;
        state.apply(step);
        state.values = state.values.cwiseMax(motion.lower).cwiseMin(motion.upper);
        constexpr double kStill = 5e-3;  // of values; rad of turn are alike in pixels
        if (iteration > 0 && step.head<3>().norm() < kStill &&
            step.tail(num_values()).cwiseAbs().maxCoeff() < 3 * kStill) {
            break;
        }
    }
    const double farthest_px = kFarthest * camera.fx / state.camera_from_head.translation().z();
    double in_sight = 0, explained = 0, correlation = 0;
    for (std::size_t k = 0; k < measurements.size(); ++k) {
        const double share = measurements[k].weight * measurements[k].texture;
        in_sight += share;
        correlation += share * measurements[k].correlation;
        if (measurements[k].correlation > kExplained && solver->robust_weights()[k] > .2 &&
            solver->distances_px()[k] < farthest_px) {
            explained += share;
            ++score.num_explained;
        }
    }
    score.correlation = ratio_or_zero(correlation, in_sight);
    const double seen = static_cast<double>(score.num_samples) / static_cast<double>(first.samples().size());
    score.quality = ratio_or_zero(explained, in_sight) * std::min(1., seen / .25);
    return score;
}

}  // namespace mimetic
