// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "pyramid.hpp"

namespace mimetic::head {

using PointRows = Eigen::Matrix<float, 3, Eigen::Dynamic>;

/// Places of a head's skin that one frame showed at one resolution; a column or an entry for each.
struct Samples {
    PointRows points;   ///< head frame, metres
    PointRows normals;  ///< head frame, outwards
    Eigen::VectorXf values;
    Eigen::VectorXf spread;                               ///< s.d. of a value: noise, and errors of position
    Eigen::VectorXf weights;                              ///< by obliqueness and by non-rigid parts
    Eigen::Matrix<float, 2, Eigen::Dynamic> gradients;    ///< of the value, per pixel
    Eigen::Matrix<float, 6, Eigen::Dynamic> jacobian;     ///< by a turn (rad) and shift (m) in the head frame
    Eigen::Matrix<float, 3, Eigen::Dynamic> depth_error;  ///< s.d. along the rays, head frame, metres
    std::vector<int> patches;                             ///< which patch of skin each belongs to
    int num_patches = 0;

    Eigen::Index size() const { return values.size(); }
};

/// Pixels of a level between samples.
int sample_spacing(const HeadOptions& options, std::size_t level);

/// The head as one frame showed it, each sample tied to the model.
class SampleView {
public:
    SampleView(const HeadShape& shape, const HeadOptions& options, const Pyramid& pyramid,
               const Eigen::Isometry3d& camera_from_head);

    const Samples& samples(std::size_t level) const { return samples_[level]; }

private:
    std::array<Samples, kLevels> samples_;
};

}  // namespace mimetic::head
