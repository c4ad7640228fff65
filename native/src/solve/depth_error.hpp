// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "face_state.hpp"

namespace mimetic {

/// What a frame's pictures show of a value too much: the value is read as value + error.
struct ReadingError {
    Eigen::Index value;
    double mean;
    double variance;
};

/// Errors of the depth of skin that some values move aside (the chin, for the jaw). The reference frame does
/// not show them, and as the head turns from it they look like a movement, by the tangent of the turn. They
/// are the same in every frame, so that frames in which the head is turned tell them.
class DepthErrors {
public:
    /// camera_from_head: of the reference frame.
    DepthErrors(const FaceMotion& motion, const Eigen::Isometry3d& camera_from_head);

    std::vector<ReadingError> at(const Eigen::Isometry3d& camera_from_head) const;

    /// reading: of a value in one frame, by the pictures alone, with its variance; num_frames: over which
    /// the value itself stays alike, so that these together tell as much as one.
    void learn(const Eigen::Isometry3d& camera_from_head, Eigen::Index value, double reading, double variance,
               double num_frames);

private:
    /// One value's: a Gaussian, in units of the value at a tangent of 1.
    struct Depth {
        Eigen::Index value;
        double value_std;  ///< of the value about 0, its prior
        double information;
        double pull;

        double mean() const { return pull / information; }
    };

    double tangent(const Eigen::Isometry3d& camera_from_head) const;

    Eigen::Matrix3d reference_;  ///< rotation
    Eigen::Vector3d sight_;      ///< unit vector from the camera to the head in the reference frame
    std::vector<Depth> depths_;
};

}  // namespace mimetic
