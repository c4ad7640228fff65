// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <memory>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/progress.hpp>
#include <mimetic/shared/types.hpp>
#include <mimetic/solve/features.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// The skin that is measured, refined once; linear in the V control vertices.
struct TrackedSurface {
    SparseRows stencils;      ///< R x V: refined vertices from control vertices
    Quads quads;              ///< of refined vertices, counter-clockwise seen from outside
    Eigen::VectorXd weights;  ///< R, 0 to 1: 0 keeps a vertex out of the measurement (hair, mouth, eyes)
    /// Of glasses before the skin, which turn with the head: curves, each N x 3, head frame, metres
    std::vector<Points> rims;
};

/// The skin of V control vertices with a weight each, refined `levels` times on its limit surface.
TrackedSurface refine_for_tracking(QuadsIn faces, VectorIn vertex_weights, int levels,
                                   std::vector<Points> rims = {});

/// How a face moves: its surface is neutral + sum of values_j modes_j + sum of detail_k detail_modes_k.
/// Muscles come first among the values, articulators after them.
struct FaceMotion {
    Points neutral;             ///< V x 3, head frame, metres
    MatrixRows modes;           ///< M x 3V (x, y, z of each vertex in turn), metres at the value 1
    int num_muscles = 0;        ///< the first num_muscles values are activations, taken as sparse
    Eigen::VectorXd lower;      ///< M
    Eigen::VectorXd upper;      ///< M
    Eigen::VectorXd prior_std;  ///< M: s.d. of a value about 0; up to 0.4 the value has a sparse prior
    MatrixRows
        detail_modes;  ///< D x 3V, D may be 0: what the values cannot explain, metres at the coefficient 1
    Eigen::VectorXd detail_std;  ///< D: s.d. of a coefficient about 0
    Eigen::VectorXd quickness;   ///< M or empty: speed, relative to a skin muscle
    /// M or empty: s.d. of the depth of the skin that a value moves along the head's x axis, in units of the
    /// value (depth / that movement at the value 1), 0 for others: by the tangent of the head's turn from the
    /// reference frame that depth looks like a movement
    Eigen::VectorXd depth_std;
    /// M squared or empty: correlation of the values about 0; without it every value goes alone
    Eigen::MatrixXd correlation;
};

struct TrackerOptions {
    int crop_height = 200;         ///< pixels of the face in the reference texture, 48 to 1024
    int sample_spacing = 4;        ///< reference pixels between samples, 1 to 16
    int max_iterations = 4;        ///< times the frame is stabilised and solved again, 1 to 20
    int max_key_views = 6;         ///< further reference textures taken during the clip, 0 to 32
    double model_error = 3.5e-4;   ///< s.d. of what the modes cannot follow, metres, correlated over the skin
    double shape_error = 5e-4;     ///< s.d. of the neutral's depth, metres: counts when the head turns
    double correlation_time = 25;  ///< frames over which a value decorrelates
    double held_quality = 0.2;     ///< below it a frame is held, 0 to 1
    bool relative_flow = true;     ///< frame-to-frame flow for the first guess
    FlowMethod flow_method = FlowMethod::dis;  ///< against the reference textures
    void check() const;                        ///< throws InvalidInput: field, value, limit
};

struct StageTimes {
    double predict_ms = 0;   ///< frame-to-frame flow and search
    double features_ms = 0;  ///< networks at eyes and mouth
    double warp_ms = 0;      ///< surface, visibility, stabilised image
    double flow_ms = 0;      ///< flow with covariance against the reference textures
    double solve_ms = 0;     ///< robust normal equations, bounds, covariance
    double total_ms = 0;
};

/// Displacement of the surface that the values leave unexplained, by coefficients of the detail modes.
struct DetailEstimate {
    Eigen::VectorXd coefficients;  ///< D
    Eigen::VectorXd std;           ///< D
    Eigen::MatrixXd information;   ///< D squared: of this frame's measurement alone
    Eigen::MatrixXd coupling;      ///< D x (6 + M): with a step of pose and values
    Eigen::VectorXd pull;          ///< D: at the estimate's pose and values and coefficients 0
};

/// State vectors are (rotation vector, translation; values): the pose after a step d is exp(d_rotation) R, t
/// + d_translation.
struct FrameEstimate {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();  ///< metres
    Eigen::VectorXd values;                                              ///< M, within their bounds
    Eigen::MatrixXd covariance;  ///< (6 + M) squared; rad, m, 1; model error included
    double quality = 0;          ///< 0 lost to 1 well explained
    bool held = false;           ///< nothing was measured: state of the last good frame
    bool found_again = false;    ///< from search or a guess, not tracked: it may be another face
    int num_samples = 0;         ///< visible samples
    int num_explained = 0;       ///< of them, the inliers
    double residual_px = 0;      ///< median distance of used samples from the model, frame pixels
    double correlation = 0;      ///< mean normalised cross-correlation of the visible samples
    int num_views = 0;           ///< reference textures used
    double covered = 0;          ///< share of the measured face turned to the camera that something is before
    StageTimes times;
    Eigen::MatrixXd information;          ///< (6 + M) squared: of this frame's measurement alone
    Eigen::VectorXd gradient;             ///< 6 + M: of this frame's measurement, at the estimate
    DetailEstimate detail;                ///< empty without detail modes
    std::array<SeenIris, 2> irises = {};  ///< the left first; `follow_gaze` turns the eyes by them
    Matrix6 pose_cov() const { return covariance.topLeftCorner<6, 6>(); }
    Eigen::VectorXd values_std() const {
        return covariance.diagonal().tail(values.size()).cwiseMax(0).cwiseSqrt();
    }
};

/// Measured positions of K points of the skin in one frame, by flow against reference textures.
struct SkinObservations {
    Triangles vertices;           ///< K x 3: refined vertices around each point
    Points barycentric;           ///< K x 3: barycentric weights
    Rows<double, 2> pixels;       ///< K x 2: where the point is in the frame, by flow alone
    Rows<double, 4> information;  ///< K x (2 x 2), frame pixels^-2; neighbours share it, outliers have 0
};

/// Tracks one face: pose, muscles and articulators together, each frame against reference textures
/// (no drift), after a first guess by frame-to-frame flow. Memory does not depend on the clip's length.
class FaceTracker {
public:
    /// image: the reference frame, in which the face is at camera_from_head with all values 0, except those
    /// of the lids, which features may measure.
    FaceTracker(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                const ColorView& image, const Eigen::Isometry3d& camera_from_head,
                const FeatureInputs& features = {}, const TrackerOptions& options = {});
    ~FaceTracker();
    FaceTracker(FaceTracker&&) noexcept;
    FaceTracker& operator=(FaceTracker&&) noexcept;

    /// The next frame. guess: where a detector sees the head, used when the face was lost.
    FrameEstimate advance(const ColorView& image, const std::optional<Eigen::Isometry3d>& guess = {});

    /// The measurements behind the last frame's estimate; none where the face was lost.
    SkinObservations observations() const;

    /// Where a frame that was just advanced to shows the outline of the face, jaw, cheeks and temples, before
    /// what is behind the head: each point tells of the direction across the outline alone. None where the
    /// face was lost.
    SkinObservations outline(const ColorView& image) const;

    /// Goes back to a state, to track the clip in the other direction; reference textures are kept.
    void restart(const ColorView& image, const FrameEstimate& estimate);

private:
    struct State;
    std::unique_ptr<State> state_;
};

struct SmootherOptions {
    /// Of the clip, a second. Accelerations are those of clips of 24 to 30; in others forces are as
    /// random in the same time, so that a second difference goes with the power 1.5 of a frame's duration
    double frame_rate = 30;
    double value_acceleration = 0.08;        ///< s.d. of a value's second difference, 1 a frame squared
    double rotation_acceleration = 0.01;     ///< rad a frame squared
    double translation_acceleration = 2e-3;  ///< metres a frame squared
    int max_iterations = 2000;               ///< of the bounds: some 200 are usual
    /// Times their upper bounds that muscles may reach which stand at them, 1 to 10: then all is solved again
    double muscle_headroom = 1;
    /// Upper bound of muscles whose own is higher: those that stand at it get their own, and all is solved
    /// again
    double first_muscle_bound = std::numeric_limits<double>::infinity();
    int fixed_first = 0;  ///< frames at the start whose states stay as they are
    int fixed_last = 0;   ///< the same at the end
    void check() const;   ///< throws InvalidInput: field, value, limit
};

/// The whole clip at once: most probable states under each frame's measurement, small accelerations and
/// the bounds, without lag (banded quadratic programme). Held frames are bridged and stay marked. What no
/// muscle at its bound asks for headroom is solved once, within the bounds.
std::vector<FrameEstimate> smooth(const std::vector<FrameEstimate>& estimates, const FaceMotion& motion,
                                  const SmootherOptions& options = {}, const Progress& progress = {});

}  // namespace mimetic
