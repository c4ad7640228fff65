// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <optional>
#include <vector>

namespace mimetic {

enum class HeadModel {
    ellipsoid,  ///< the paper's (section 4)
    plane,      ///< the patch that the paper compares with: an ellipse that faces forwards
    surface,    ///< the person's own surface: the upper bound
};

/// A non-rigid part of the face (mouth, eyes): measurements near it are weighted down.
struct MovingPart {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< x, y in the head frame, metres
    double radius = 0.02;                              ///< metres, of a Gaussian
    double share = 0.8;                                ///< taken from the weight at the centre, 0 to 1
};

/// The rigid body that stands for the head, head frame, metres.
struct HeadShape {
    HeadModel model = HeadModel::ellipsoid;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< ellipsoid, plane
    Eigen::Vector3d half_axes{.075, .11, .095};          ///< along x, y, z; the plane has no z
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< ellipsoid: its axes, columns, in the head frame
    Points vertices;                                     ///< surface: V x 3
    Quads faces;                                         ///< surface: counter-clockwise seen from outside
    double depth_error = 5e-3;                           ///< s.d. of the head's depth about the model
    std::vector<MovingPart> moving_parts;
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// The model that lies nearest to a head's skin, symmetric about x = 0, with its depth_error measured.
/// vertices: V x 3; faces: of the skin that is seen. Throws InvalidInput if no such body fits.
HeadShape make_head_shape(HeadModel model, PointsIn vertices, QuadsIn faces);

struct HeadOptions {              // defaults suit 320x240 to 1280x720 at 10 to 60 frames a second
    int crop_height = 112;        ///< pixels of the head in what is measured, 48 to 512
    int sample_spacing = 3;       ///< of these pixels, between measurements, 1 to 16
    int max_iterations = 4;       ///< times a frame is stabilised and solved again, 1 to 20
    int max_key_views = 24;       ///< reference textures; 0: flow alone, as in the paper, 0 to 200
    double key_view_angle = 0.2;  ///< rad between the head's directions in reference textures
    double least_facing = 0.35;   ///< least cosine of normal and view at which skin is measured
    double held_quality = 0.2;    ///< below it a frame is held, 0 to 1
    FlowMethod flow_method = FlowMethod::probabilistic;
    double frame_rate = 30;  ///< frames a second that are shown to the tracker, 1e-5 to 1e6
    bool fast = false;       ///< registers samples of the skin; flow only where that is uncertain
    void check() const;      ///< throws InvalidInput: field, value, limit
};

struct HeadEstimate {
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();  ///< metres
    Matrix6 covariance = Matrix6::Zero();  ///< exp(rotation) R, t + translation; rad, m; model error included
    double quality = 0;                    ///< 0 lost to 1 well explained
    bool held = false;                     ///< nothing was measured: repeats the last good pose
    bool found_again = false;              ///< from search or a guess, not tracked: it may be another head
    double likeness = 0;                   ///< share of the visible skin that matches a reference texture
    int num_samples = 0;                   ///< visible measurements
    double explained = 0;                  ///< the share of inliers among them
    double residual_px = 0;                ///< their median distance from the model, pixels of the frame
    double correlation = 0;                ///< of the stabilised frame with the reference texture, -1 to 1
    int num_views = 0;                     ///< reference textures taken so far
};

/// Pose of a reference texture by each of two models of one head; camera from head, metres.
struct PlacedView {
    Eigen::Isometry3d on_model = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d on_skin = Eigen::Isometry3d::Identity();
};

/// Follows a rigid head in 6 degrees of freedom: the finite motion that best explains the flow since the
/// frame before, then registration with reference textures, so that errors do not accumulate. Memory does not
/// depend on the clip's length.
class HeadTracker {
public:
    /// image: the frame in which the head is at camera_from_head.
    HeadTracker(const Camera& camera, const HeadShape& shape, const ColorView& image,
                const Eigen::Isometry3d& camera_from_head, const HeadOptions& options = {});
    ~HeadTracker();
    HeadTracker(HeadTracker&&) noexcept;
    HeadTracker& operator=(HeadTracker&&) noexcept;

    /// The next frame. guess: where a detector sees the head, tried when the head was lost.
    HeadEstimate advance(const ColorView& image, const std::optional<Eigen::Isometry3d>& guess = {});

    /// Drops the reference textures of the last `num_last` frames: these show something else.
    void forget(int num_last);

    /// Goes back to a frame, to track the clip in the other direction; reference textures are kept.
    void restart(const ColorView& image, const HeadEstimate& estimate);

    /// Registers the reference textures with each other again, and solves for their poses and the shape: a
    /// second pass over the clip then tracks better. False: no two of them show the same skin.
    bool relax();

    /// Solves for the reference textures' poses once more, on the head's own surface: a simple model
    /// that is flatter than the head and turns further explains nearly the same flow. Empty: where relax is
    /// false.
    std::vector<PlacedView> place_on(const HeadShape& skin);

    /// Moves the reference textures, in their order, and shapes the model so that it agrees with their poses
    /// (camera from head). Throws InvalidInput if there are more or fewer of them.
    void move_views(const std::vector<Eigen::Isometry3d>& poses);

    /// The model as it is now: shape and place in the head come from all reference textures together.
    const HeadShape& shape() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace mimetic
