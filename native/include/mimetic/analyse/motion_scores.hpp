// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Points count as moving where the truth is farther than this from rigid motion.
constexpr double kMovingPx = .75;
constexpr double kMovingMetres = .001;

/// Points over frames: N x 2K pixels or N x 3K metres, a point's coordinates next to each other.
using Tracks = MatrixRows;
using TracksIn = MatrixIn;

/// Which points count in which frames: N x K, 0 or 1.
using SeenIn = const Eigen::Ref<const Rows<std::uint8_t, Eigen::Dynamic>>&;

/// Scores of predicted tracks against true ones, relative to their positions in the first frame.
struct ImageScores {
    double explained,
        explained_beyond_head;           ///< R2 about zero of all motion, and of that beyond rigid motion
    double median_px, percentile_95_px;  ///< of the distance
    double moving_median_px;             ///< of points that move beyond rigid motion
    double beyond_head_rms_px;           ///< of the true motion
};

/// tracks, predicted: N x 2K; rigid: where the true head's motion alone would take the first frame's points.
/// Throws InvalidInput on arrays of different shapes.
ImageScores score_image_motion(TracksIn tracks, TracksIn rigid, SeenIn seen, TracksIn predicted);

/// Metres of the surface in two head frames. Head frames of two models differ by how each was fitted: the
/// predicted motion is turned by the rotation that best aligns its first points with the true ones.
struct SurfaceScores {
    double explained;         ///< R2
    double median_mm;         ///< of the distance, the first frame's taken out
    double moving_median_mm;  ///< of points that move
    double shape_median_mm;   ///< of the first frame's points, aligned
};

/// points, predicted: N x 3K. Throws InvalidInput on arrays of different shapes.
SurfaceScores score_surface_motion(TracksIn points, SeenIn seen, TracksIn predicted);

/// N x 3 rotation vectors, degrees, camera axes, of the error in turning since the first frame.
Points head_turn_errors(const std::vector<Eigen::Isometry3d>& true_poses,
                        const std::vector<Eigen::Isometry3d>& poses);

}  // namespace mimetic
