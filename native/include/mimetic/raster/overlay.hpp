// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/quad_edges.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/color_image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

struct OverlayOptions {
    int scale = 1;                  ///< pictures are enlarged by this, so that thin lines stay apart, 1 to 8
    double opacity = 0.55;          ///< of the lines, 0 to 1
    double depth_tolerance = 4e-3;  ///< metres that a line may lie behind the surface and still be drawn
    double held_quality = 0.2;      ///< below it the frame is drawn and labelled as held
    void check() const;             ///< throws InvalidInput: field, value, limit
};

class DepthMap;

/// Draws what was captured over the footage: the mesh where it faces the camera and is not occluded,
/// landmarks, a quality bar and the frame's number.
class OverlayPainter {
public:
    /// faces: quads of V vertices; landmarks: vertices drawn as dots. Throws InvalidInput on indices out of
    /// range.
    OverlayPainter(const Camera& camera, int num_vertices, QuadsIn faces, std::vector<int> landmarks,
                   const OverlayOptions& options = {});

    /// vertices_in_camera: V x 3, metres; quality: 0 to 1; the image has the camera's size. rings: closed
    /// lines (K x 3, metres, camera), the irises' rims, drawn where no skin covers them.
    ColorImage paint(const ColorView& image, PointsIn vertices_in_camera, double quality, int frame,
                     const std::vector<Points>& rings = {}) const;

private:
    /// Where a vertex is in the enlarged picture.
    struct Place {
        Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
        bool is_shown = false;  ///< in the picture and not occluded
    };

    std::vector<Place> find_places(PointsIn points_in_camera, const DepthMap& depth, double tolerance) const;

    Camera camera_;  ///< of the enlarged picture
    OverlayOptions options_;
    int num_vertices_;
    QuadEdges mesh_;
    std::vector<int> landmarks_;
};

}  // namespace mimetic
