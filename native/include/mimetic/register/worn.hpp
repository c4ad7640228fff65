// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// A head as it is seen from 26 directions, by which what it wears (glasses, a hat) is distinguished from
/// what belongs to its face: what lies behind the skin or in its openings (eyeballs, teeth, tongue), what
/// lies on it (lashes, a beard), and balls and caps of them (eyes that bulge).
class HeadViews {
public:
    /// points: V x 3, of any axes and unit; triangles: T x 3, counter-clockwise seen from outside;
    /// metres_from_points: 4 x 4. Throws InvalidInput on a vertex that does not exist, on points that are not
    /// finite and on a matrix that flattens them.
    HeadViews(PointsIn points, TrianglesIn triangles, const Eigen::Matrix4d& metres_from_points);

    /// Whether a mesh (P x 3, the head's frame and unit) that is small beside the head is worn by it.
    bool wears(PointsIn part) const;

private:
    struct View {
        Eigen::Vector3d direction, aside, up;  ///< towards the viewer; of the picture's columns and rows
        double left = 0, bottom = 0, pixel = 1;
        Raster nearest;
    };
    /// What a sample of a part is like.
    struct Sample {
        int num_before = 0;  ///< views in which it lies before the skin
        int num_within = 0;  ///< views that see it, and the skin's inner side behind it
        double gap = 0;      ///< least distance to the skin behind it; infinity where there is none
    };

    Sample look_at(const Eigen::Vector3d& point) const;

    std::vector<View> views_;
    std::vector<std::vector<bool>> shows_outside_;  ///< by view and triangle
    double extent_ = 0;
    double near_ = 0;  ///< what lies so far before the skin lies on it, in the points' unit
};

}  // namespace mimetic
