// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <unordered_set>

#include "expectation.hpp"
#include "feature_evidence.hpp"
#include "sight.hpp"

namespace mimetic {

/// Wall clock of one stage, added to a total when it goes out of scope.
class StageClock {
public:
    explicit StageClock(double& total_ms) : total_ms_(total_ms), start_(std::chrono::steady_clock::now()) {}
    ~StageClock() {
        total_ms_ +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;

private:
    double& total_ms_;
    std::chrono::steady_clock::time_point start_;
};

/// The present frame.
struct FrameAtHand {
    ColorView color;
    cv::Mat1b gray;
    PreparedFrame prepared;  ///< for the textures' resolution
    StageTimes times;        ///< spent on it
};

/// How well a state explains a frame.
struct FrameScore {
    double quality = 0;
    double correlation = 0;
    Look look;  ///< beside the reference texture that shows it best
    int num_samples = 0;
    int num_explained = 0;
    int num_views = 0;
};

/// Measurements of a frame against the textures, from a hypothesis.
struct Measured {
    std::vector<SampleMeasurement> samples;
    ProjectedSurface projected;  ///< the hypothesis, from which displacements count
};

/// Result of registering a frame: the face's state, the measurements behind it, and their fit.
struct Registration {
    FaceState state;
    FaceStep last_step;  ///< of the solver's last linearisation
    Measured measured;
    FrameScore score;
};

/// Finds the state that explains a frame by the reference textures, and whether it is this face at all.
class FaceRegistrar {
public:
    FaceRegistrar(const TrackedFace& face, const ReferenceViews& views, ErrorField<float> error_field,
                  const FeatureEvidence& features, const Cover& cover);

    /// Starts from a state. A quality under held_quality: it is not the face that recognition knows.
    Registration register_face(const Expectation& expected, const FaceState& start, FrameAtHand& frame,
                               const Recognition& recognition);

    /// The same for the pose alone, without asking whether it is this face.
    FaceState register_pose(const Expectation& expected, const FaceState& start, FrameAtHand& frame);

    /// The share of what came before the face that looks like the skin it is said to hide, with the face in a
    /// state; 0 where nothing came.
    double alike_behind_cover(const FaceState& state, FrameAtHand& frame);

    /// The equations of the last registration.
    const JointSolver& solver() const { return solver_; }

private:
    using Covered =
        std::unordered_set<const ReferenceSample*>;  // occluded: they carry no information on the face

    struct Effort {
        int num_iterations;
        Eigen::Index num_free;  // unknowns, the first ones
    };

    struct Appearance {
        Look look;                 // beside the reference texture that shows it best
        double alike_in_flow = 0;  // share of the textures that flow is measured between that is alike
        Covered covered;
    };

    Registration register_textures(const Expectation& expected, const FaceState& start, FrameAtHand& frame,
                                   const Covered& covered, Effort effort);
    void measure(const FaceState& state, FrameAtHand& frame, bool is_first, bool is_last,
                 Registration& registration);
    void score_samples(const FaceState& state, Registration& registration) const;
    Appearance look_at(const FaceState& state, FrameAtHand& frame);
    double face_height(const FaceState& state) const;  ///< pixels
    bool is_vague(const Expectation& expected) const;

    const TrackedFace& face_;
    const ReferenceViews& views_;
    const FeatureEvidence& features_;
    const Cover& cover_;
    JointSolver solver_;
    TextureFlow texture_flow_;
    Sight sight_;
    Likeness likeness_;
    cv::Mat2f map_;  // of each pixel of the stabilised texture
    cv::Mat1f stabilised_;
};

}  // namespace mimetic
