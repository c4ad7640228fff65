// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

#include "reference_view.hpp"

namespace mimetic {

/// Finds a lost face again by its appearance in the reference frame, at several sizes.
class LostFaceSearch {
public:
    LostFaceSearch(const cv::Mat1b& reference, const ReferenceView& view);

    /// Best places of the face, most alike first; face_scale: present size over the reference's, as last
    /// seen.
    std::vector<Eigen::Isometry3d> find(const Camera& camera, const cv::Mat1b& gray, double face_scale) const;

private:
    cv::Mat1b template_;
    double template_scale_ = 1;  // template pixels a reference pixel
    Eigen::Vector2d centre_;     // of the template in the reference frame, pixels
    Eigen::Isometry3d camera_from_head_;
};

}  // namespace mimetic
