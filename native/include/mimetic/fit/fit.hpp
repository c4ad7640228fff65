// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/locate/locate.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/scale.hpp>

namespace mimetic {

/// A head that changes with identity coefficients: points + sum_i coefficient_i modes_i, metres, head frame.
struct FaceModel {
    Points points;                            ///< P x 3, on the surface
    MatrixRows modes;                         ///< I x 3P, one identity mode a row
    Eigen::VectorXd spread;                   ///< I, prior standard deviation of each coefficient
    MatrixRows limits;                        ///< I x 2, least and largest coefficient
    Quads faces;                              ///< F x 4 point indices, whose silhouette gives the outline
    std::vector<bool> on_outline;             ///< P, whether the jaw's outline may pass here
    std::vector<std::string> landmark_names;  ///< L; `pupil.L` and `pupil.R` are the eyeballs' centres
    SparseRows landmark_weights;              ///< L x P, rows sum to 1
    std::vector<std::string> curve_names;     ///< C
    std::vector<std::vector<int>> curves;     ///< C, point indices along `lip_line`, `brow.L`, ...

    void check() const;                         ///< throws InvalidInput: field, size, limit
    Points shaped(VectorIn identity) const;     ///< P x 3
    Points landmarks(VectorIn identity) const;  ///< L x 3
};

struct FitOptions {
    bool focal_free = false;     ///< whether the focal length is estimated as well
    bool shape_free = true;      ///< whether the proportions are estimated; if not, those of `start` are kept
    bool pose_free = true;       ///< whether poses are estimated; if not, those of `start` are kept
    double focal_spread = 0.2;   ///< prior standard deviation of its logarithm
    double pitch_spread = 0.12;  ///< prior standard deviation of the head's pitch to the camera, rad:
                                 ///< features hardly separate it from long or short proportions
    double yaw_spread = 0.6;     ///< the same for yaw, which they determine well
    double gaze_spread = 0.02;   ///< s.d. of the pupils' shift by gaze, interpupillary distances
    double elsewhere = 3.0;      ///< factor on the s.d. of features in views after the first: all share the
                                 ///< same errors, and in the first the face is most at rest
    double robust_scale = 1.5;   ///< residuals beyond this many standard deviations count for less
    int max_rounds = 8;          ///< times that outlines are matched again
    double pupil_distance = kPupilDistance;  ///< metres: the scale
    void check() const;                      ///< throws InvalidInput: field, value, limit
};

/// How far a point of the model moved in the image from the first view to another.
struct PointMotion {
    int point = 0;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< pixels
    double sigma_px = 1;
};

/// What is known of one picture of the person.
struct FaceView {
    FaceFeatures features;
    std::vector<Feature> pins;  ///< landmarks placed by hand: they stand for the measured ones of their names
                                ///< and are held, however far off
    std::vector<PointMotion> motion;  ///< since the first view; empty for the first
};

struct FaceEstimate {
    std::vector<Eigen::Isometry3d> camera_from_head;  ///< one a view, metres
    double focal = 0;                                 ///< pixels
    Eigen::VectorXd identity;                         ///< I
    double rms_ipd = 0;  ///< of the points' and curves' residuals, interpupillary distances
    int iterations = 0;  ///< of the solver over all rounds
    bool converged = false;
};

/// Pose of every view, and the proportions and focal length that they share: robust least squares (Ceres)
/// with Gaussian priors on the coefficients. Focal lengths of the camera must be equal.
/// The first view is the reference frame, where the face is at rest: features of others weigh little. Depth
/// follows from how far points move between views (parallax).
/// start: an estimate for the same views to go on from. Throws InvalidInput when features lack the pupils or
/// a pin's name is no landmark.
FaceEstimate fit_face(const FaceModel& model, const std::vector<FaceView>& views, const Camera& camera,
                      const FitOptions& options = {}, const FaceEstimate* start = nullptr);

/// Landmarks and curves of the fitted model in a view's image, pixels: what to look for in the next
/// measurement.
FaceFeatures project_features(const FaceModel& model, const FaceEstimate& estimate, const Camera& camera,
                              std::size_t view = 0);

}  // namespace mimetic
