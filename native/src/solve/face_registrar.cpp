// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_registrar.hpp"

namespace mimetic {

namespace {

constexpr std::size_t kFewest = 30;  // samples that a state can be estimated from
constexpr double kFarthest = .008;   // metres from the model up to which a sample is an inlier
constexpr double kExplained = .5;    // correlation from which a patch shows the same skin
constexpr double kStill = 5e-3;      // of values; rad of turn are alike in pixels

constexpr double kVague = .07;  // rad: s.d. of a pose about some axis that is not measured

double ratio_or_zero(double part, double whole) { return whole > 0 ? part / whole : 0; }

}  // namespace

FaceRegistrar::FaceRegistrar(const TrackedFace& face, const ReferenceViews& views,
                             ErrorField<float> error_field, const FeatureEvidence& features,
                             const Cover& cover)
    : face_(face),
      views_(views),
      features_(features),
      cover_(cover),
      solver_(face.motion, std::move(error_field)),
      texture_flow_(face.options.flow_method),
      sight_(face, cover),
      likeness_(face.options.crop_height) {}

Registration FaceRegistrar::register_face(const Expectation& expected, const FaceState& start,
                                          FrameAtHand& frame, const Recognition& recognition) {
    const double held_quality = face_.options.held_quality;
    Registration found =
        register_textures(expected, start, frame, {}, {face_.options.max_iterations, face_.num_unknowns()});
    if (found.score.quality < held_quality) {
        return found;
    }
    Appearance seen = look_at(found.state, frame);
    if (recognition.accepts(seen.look) && seen.alike_in_flow < Recognition::kPlain) {
        // An occluder moves independently: solve once more from the samples that are the face's.
        const FrameScore score = found.score;
        found = register_textures(expected, found.state, frame, seen.covered, {2, face_.num_unknowns()});
        const bool is_registered = found.score.quality >= held_quality && !is_vague(expected);
        seen = is_registered ? look_at(found.state, frame) : Appearance{};
        found.score = score;
    }
    found.score.look = seen.look;
    if (!recognition.accepts(seen.look)) {
        found.score.quality = std::min(found.score.quality, .99 * held_quality);
    }
    return found;
}

FaceState FaceRegistrar::register_pose(const Expectation& expected, const FaceState& start,
                                       FrameAtHand& frame) {
    constexpr int kIterations = 4;
    return register_textures(expected, start, frame, {}, {kIterations, FaceStep::kPose}).state;
}

Registration FaceRegistrar::register_textures(const Expectation& expected, const FaceState& start,
                                              FrameAtHand& frame, const Covered& covered, Effort effort) {
    Registration registration;
    FaceState& state = registration.state = start;
    std::vector<SampleMeasurement>& samples = registration.measured.samples;
    for (int iteration = 0; iteration < effort.num_iterations; ++iteration) {
        if (!(state.camera_from_head.translation().z() > .02)) {
            registration.score = {};
            return registration;
        }
        measure(state, frame, iteration == 0, iteration + 1 == effort.num_iterations, registration);
        if (samples.size() < kFewest) {
            registration.score = {};
            return registration;
        }
        const auto num_views = static_cast<float>(registration.score.num_views);
        for (SampleMeasurement& sample : samples) {
            // Textures of the same skin share the model's error: two of them give no more information than
            // one.
            const bool is_skin = !sample.sample->is_behind_rim && !covered.contains(sample.sample);
            sample.weight = is_skin ? sample.weight / num_views : 0;
        }
        const StageClock clock(frame.times.solve_ms);
        NoiseModel present = face_.noise;
        present.robust_cut *= iteration == 0 ? 2.5 : 1;  // far off at first
        solver_.linearise(face_.camera, state, samples, present);
        solver_.add(features_.terms(state));
        solver_.allow(expected.depth_errors.at(state.camera_from_head));
        FaceStep& step = registration.last_step = FaceStep(
            solver_.solve(expected.from(state, face_), state, effort.num_free, iteration == 0 ? 3 : 2));
        state.apply(step);
        state.keep_within(face_.motion);
        if (iteration > 0 && step.rotation().norm() < kStill &&
            step.values().cwiseAbs().maxCoeff() < 3 * kStill) {
            break;
        }
    }
    score_samples(state, registration);
    return registration;
}

void FaceRegistrar::measure(const FaceState& state, FrameAtHand& frame, bool is_first, bool is_last,
                            Registration& registration) {
    auto& [samples, projected] = registration.measured;
    samples.clear();
    {
        const StageClock clock(frame.times.warp_ms);
        projected.update(face_.surface, face_.camera, state.camera_from_head, state.values);
        if (is_first) {
            sight_.draw(projected, state, face_height(state));
        } else {
            sight_.follow(projected, state, face_height(state));
        }
    }
    const std::vector<ReferenceView*> near = views_.near(state.camera_from_head);
    for (ReferenceView* view : near) {
        std::vector<float> visible;
        {
            const StageClock clock(frame.times.warp_ms);
            visible = sight_.visible(*view, projected, state);
            view->stabilise(face_.surface.triangles(), projected, frame.prepared, map_, stabilised_,
                            /*for_flow=*/true);
        }
        const StageClock clock(frame.times.flow_ms);
        const double angle = view_angle(view->camera_from_head(), state.camera_from_head);
        texture_flow_.measure(*view, map_, stabilised_, visible, std::sin(std::min(1.5, angle)),
                              is_first && !is_last, samples);
    }
    registration.score.num_views = static_cast<int>(near.size());
    registration.score.num_samples = static_cast<int>(samples.size());
}

void FaceRegistrar::score_samples(const FaceState& state, Registration& registration) const {
    const std::vector<SampleMeasurement>& samples = registration.measured.samples;
    FrameScore& score = registration.score;
    const double farthest_px = kFarthest * face_.camera.fx / state.camera_from_head.translation().z();
    double in_sight = 0, explained = 0, correlation = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double share = samples[k].weight * samples[k].texture;
        in_sight += share;
        correlation += share * samples[k].correlation;
        if (samples[k].correlation > kExplained && solver_.robust_weights()[k] > .2 &&
            solver_.distances_px()[k] < farthest_px) {
            explained += share;
            ++score.num_explained;
        }
    }
    score.correlation = ratio_or_zero(correlation, in_sight);
    const double seen =
        static_cast<double>(score.num_samples) / static_cast<double>(views_.first().samples().size());
    score.quality = ratio_or_zero(explained, in_sight) * std::min(1., seen / .25);
}

double FaceRegistrar::face_height(const FaceState& state) const {
    return views_.pixels_per_crop_pixel(state.camera_from_head) * face_.options.crop_height;
}

FaceRegistrar::Appearance FaceRegistrar::look_at(const FaceState& state, FrameAtHand& frame) {
    const StageClock clock(frame.times.warp_ms);
    ProjectedSurface projected;
    projected.update(face_.surface, face_.camera, state.camera_from_head, state.values);
    sight_.follow(projected, state, face_height(state));
    Appearance seen;
    for (ReferenceView* view : views_.near(state.camera_from_head)) {
        const std::vector<float> visible = sight_.visible(*view, projected, state);
        view->stabilise(face_.surface.triangles(), projected, frame.prepared, map_, stabilised_);
        const cv::Mat1f weights = view->sample_weights(visible);
        const Look one = likeness_.compare(view->texture(), stabilised_, weights);
        seen.look = {std::max(seen.look.alike, one.alike), std::max(seen.look.detail, one.detail)};
        double alike_in_flow = one.alike;
        if (view->has_finer_flow_texture()) {  // of what is broad, flow sees nothing
            view->normalise_for_flow(stabilised_);
            alike_in_flow = likeness_.compare(view->flow_texture(), stabilised_, weights).alike;
        }
        seen.alike_in_flow = std::max(seen.alike_in_flow, alike_in_flow);
        for (const ReferenceSample& sample : view->samples()) {
            if (weights(sample.y, sample.x) == 0 ||
                likeness_.correlations()(sample.y, sample.x) < Likeness::kAlike) {
                seen.covered.insert(&sample);
            }
        }
    }
    return seen;
}

double FaceRegistrar::alike_behind_cover(const FaceState& state, FrameAtHand& frame) {
    if (!cover_.hides_any()) {
        return 0;
    }
    const StageClock clock(frame.times.warp_ms);
    ProjectedSurface projected;
    projected.update(face_.surface, face_.camera, state.camera_from_head, state.values);
    ReferenceView& view = *views_.near(state.camera_from_head).front();
    const Triangles& triangles = face_.surface.triangles();
    const Eigen::Vector3f eye = eye_in_head(state);
    std::vector<const ReferenceSample*> behind;
    for (const ReferenceSample& sample : view.samples()) {
        if (turned_to_camera(sample, triangles, projected, eye) > 0 &&
            cover_.came(place_of(sample, triangles, projected).cast<double>())) {
            behind.push_back(&sample);
        }
    }
    if (behind.empty()) {
        return 0;
    }
    view.stabilise(face_.surface.triangles(), projected, frame.prepared, map_, stabilised_);
    const cv::Mat1f everywhere = view.sample_weights(std::vector<float>(view.samples().size(), 1));
    likeness_.compare(view.texture(), stabilised_, everywhere);
    const auto num_alike = std::ranges::count_if(behind, [this](const ReferenceSample* sample) {
        return likeness_.correlations()(sample->y, sample->x) >= Likeness::kAlike;
    });
    return static_cast<double>(num_alike) / static_cast<double>(behind.size());
}

bool FaceRegistrar::is_vague(const Expectation& expected) const {
    const Eigen::Index size = face_.num_unknowns();
    const Eigen::MatrixXd spread =
        (solver_.information() + expected.information).llt().solve(Eigen::MatrixXd::Identity(size, size));
    return !(spread.diagonal().head<3>().maxCoeff() < kVague * kVague);
}

}  // namespace mimetic
