// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "locate/likeness.hpp"
#include "rigid_motion.hpp"
#include "seen_head.hpp"

namespace mimetic::head {

/// The flow from one crop of the head to another of the same camera, as measurements of the model's points.
/// Their depth errors lie along the rays of `camera_from_head`, the pose in `before`.
std::vector<PointMeasurement> measure_flow(const HeadShape& shape, const HeadOptions& options,
                                           const HeadCrop& before, const HeadCrop& now,
                                           const Eigen::Isometry3d& camera_from_head);

/// A frame's texture fetched through a model at a hypothesis.
struct Stabilised {
    cv::Mat2f map;           ///< crop pixel of each texture pixel; below -1e5: not visible
    cv::Mat1f texture;       ///< light and contrast normalised; 0 where not visible
    double correlation = 0;  ///< with the reference texture, -1 to 1
    double in_sight = 0;     ///< visible share of the reference texture
};

/// The head's texture as one frame showed it, each pixel tied to the model.
class KeyView {
public:
    KeyView(const HeadShape& shape, const HeadOptions& options, const HeadCrop& crop,
            const Eigen::Isometry3d& camera_from_head, const Matrix6& covariance);

    Stabilised stabilise(const HeadCrop& now, const Eigen::Isometry3d& hypothesis) const;

    /// Appends where the texture's points are in the crop's pixels.
    void measure(const HeadShape& shape, const HeadOptions& options, const Stabilised& stabilised,
                 double share, std::vector<PointMeasurement>& measurements) const;

    /// Weight of each pixel of the texture, 0 where it is not visible or between samples.
    cv::Mat1f weights(const HeadShape& shape, const HeadOptions& options, const Stabilised& stabilised) const;

    /// Corrects pose and model to those that later views give.
    void move(const HeadShape& shape, const Eigen::Isometry3d& camera_from_head, const Matrix6& covariance);

    const ReferenceTexture& texture() const { return texture_; }
    const HeadCrop& crop() const { return crop_; }
    bool shows(int x, int y) const { return mask_(y, x) != 0; }
    Eigen::Vector3d point(int x, int y) const { return to_eigen(seen_.points(y, x)); }
    Eigen::Vector3d normal(int x, int y) const { return to_eigen(seen_.normals(y, x)); }
    const Eigen::Isometry3d& camera_from_head() const { return camera_from_head_; }
    const Matrix6& covariance() const { return covariance_; }

private:
    static Eigen::Vector3d to_eigen(const cv::Vec3f& v) { return {v[0], v[1], v[2]}; }
    void normalise(cv::Mat1f& image, const cv::Mat1f& mask) const;

    Eigen::Isometry3d camera_from_head_;
    Matrix6 covariance_;
    HeadCrop crop_;
    SeenHead seen_;
    cv::Mat1f mask_;
    ReferenceTexture texture_;
    double least_facing_;
};

}  // namespace mimetic::head
