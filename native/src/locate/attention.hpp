// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <mimetic/shared/types.hpp>
#include <opencv2/core.hpp>
#include <span>

namespace mimetic::locate {

/// Places in a part's own square, (0, 0) to (1, 1), to places in the crop, likewise: an affine map.
using PartSquare = Eigen::Matrix<double, 2, 3>;

/// A part of the face that MediaPipe's mesh with attention refines: one of its heads reads the feature
/// maps in a square round the part's points, turned so that two of them are level.
struct AttentionPart {
    std::span<const int> points;  ///< of the mesh, in the order of the head's output
    int left = 0, right = 0;      ///< points of the mesh that are level, in the picture's order
};

extern const AttentionPart kLipsPart;
extern const std::array<AttentionPart, 2> kEyeParts;  ///< the subject's left first

/// The square of a part whose points lie there: 1.5 times their box. mesh: 468 x 2, in sides of the crop.
PartSquare square_of(const AttentionPart& part, const Points2& mesh);

/// The input of a head: 1 x channels x 16 x 16, of maps 1 x channels x rows x columns of float32; 0 beside
/// them.
cv::Mat seen_in(const cv::Mat& maps, const PartSquare& square);

/// The points that a head gives (x, y in pixels of a square of 64), in sides of the crop.
Points2 points_of(const cv::Mat& output, const PartSquare& square);

}  // namespace mimetic::locate
