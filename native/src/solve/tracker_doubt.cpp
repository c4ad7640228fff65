// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracker_state.hpp"

namespace mimetic {

namespace {

constexpr double kPlain = .6;   // likeness below which something covers the face
constexpr double kVague = .07;  // rad: s.d. of a pose about some axis that is not measured

}  // namespace

/// Share of the texture in sight that looks as it should, by the reference texture that shows it best. What
/// does not is kept in `unlike`.
double FaceTracker::State::look() {
    const StageClock clock(times.warp_ms);
    unlike.clear();
    ProjectedSurface here;
    here.update(surface, camera, state.camera_from_head, state.values);
    std::swap(here, projected);  // the measurement's own hypothesis is asked for later
    double best = 0;
    for (const std::size_t index : choose_views()) {
        ReferenceView& view = *views[index];
        find_visible(view, visible);
        view.stabilise(surface.triangles(), projected, frame, map, stabilised);
        const cv::Mat1f weights = view.sample_weights(visible);
        best = std::max(best, likeness.compare(view.texture(), stabilised, weights));
        for (const ReferenceSample& sample : view.samples()) {
            if (weights(sample.y, sample.x) == 0 ||
                likeness.correlations()(sample.y, sample.x) < Likeness::kAlike) {
                unlike.insert(&sample);
            }
        }
    }
    std::swap(here, projected);
    return best;
}

bool FaceTracker::State::is_vague(const StepPrior& prior) const {
    const Eigen::Index size = 6 + num_values();
    const Eigen::MatrixXd spread =
        (solver->information() + prior.information).llt().solve(Eigen::MatrixXd::Identity(size, size));
    return !(spread.diagonal().head<3>().maxCoeff() < kVague * kVague);
}

/// Registers from the present state on and looks whether the face is there, at least so alike. A quality
/// under the held one: it is not.
FrameScore FaceTracker::State::register_face(const StepPrior& prior, double least) {
    const Eigen::Index all = 6 + num_values();
    unlike.clear();
    FrameScore score = register_textures(prior, options.max_iterations, all);
    if (score.quality < options.held_quality) {
        return score;
    }
    score.likeness = look();
    if (score.likeness >= least && score.likeness < kPlain) {
        // What covers the face moves on its own: once more by what is known to be the face.
        const FrameScore uncovered = register_textures(prior, 2, all);
        const bool is_registered = uncovered.quality >= options.held_quality && !is_vague(prior);
        score.likeness = is_registered ? look() : 0;
    }
    unlike.clear();
    if (score.likeness < least) {
        score.quality = std::min(score.quality, .99 * options.held_quality);
    }
    return score;
}

FrameScore FaceTracker::State::search_again(const StepPrior& prior, double near_quality,
                                            const std::optional<Eigen::Isometry3d>& guess) {
    std::vector<Eigen::Isometry3d> poses;
    {
        const StageClock clock(times.predict_ms);
        poses = search->find(camera, gray, face_pixels_per_crop_pixel() * views.front()->scale());
    }
    if (guess) {
        poses.push_back(*guess);
    }
    poses.push_back(last.camera_from_head);  // without the flow, which may have followed what covers it
    FaceState best = state;
    double best_quality = near_quality;
    for (const Eigen::Isometry3d& pose : poses) {
        state.camera_from_head = pose;
        state.values.setZero();
        // Where the face was says nothing about where it is now.
        predicted = state;
        frame.update(gray, 1 / face_pixels_per_crop_pixel());
        unlike.clear();
        register_textures(prior, 4, 6);
        predicted.camera_from_head = state.camera_from_head;
        const FrameScore score = register_face(prior, kSurelyAlike);
        if (score.quality > best_quality) {
            best_quality = score.quality;
            best = state;
        }
    }
    // Once more where it fits best: the solver must not be left with another candidate's equations.
    state = predicted = best;
    frame.update(gray, 1 / face_pixels_per_crop_pixel());
    return register_face(prior, kSurelyAlike);
}

}  // namespace mimetic
