// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/locate/feature_crops.hpp>
#include <mimetic/locate/locate.hpp>
#include <mimetic/shared/image.hpp>
#include <opencv2/core.hpp>
#include <vector>

namespace mimetic::locate {

constexpr double kGridSide = 200;  ///< of a face's square, in pixels of the grid that frames are compared on

/// The part of a frame about its face, on a grid that all frames of a clip share.
struct FaceLook {
    FeatureCrop square;           ///< `occlusion_square`, pixels of the grid, as `points`
    std::vector<Feature> points;  ///< as they were found
    cv::Rect place;               ///< on the grid; empty where the face is beside the picture
    cv::Mat2f slopes;             ///< of grey levels, right and down, a pixel of the grid
    cv::Mat1f fine;               ///< grey levels beside those about them: whatever the light

    /// The slope at a place of the grid; nullptr beside the look.
    const cv::Vec2f* slope_at(int y, int x) const;

    /// As `outward_of_face` has it, of a place of the grid.
    double outward(int y, int x) const;
    bool is_face(int y, int x) const { return outward(y, x) < 1; }
};

/// square, points: pixels of the picture; scale: pixels of the grid for one of these.
FaceLook look_at(const ColorView& image, const FeatureCrop& square, const std::vector<Feature>& points,
                 double scale);

/// By look the similarity that takes places of one look's face to where that look has them: that by which the
/// face is most alike, near where its points say or near where it is in the picture. Points scatter by a few
/// pixels, and a face that stands still must not seem to move behind itself. What hides a part is unlike
/// everywhere.
std::vector<Eigen::Affine2d> aligned(const FaceLook& one, const std::vector<FaceLook>& looks);

}  // namespace mimetic::locate
