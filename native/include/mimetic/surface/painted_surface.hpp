// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <mimetic/raster/overlay.hpp>
#include <mimetic/surface/surface.hpp>
#include <vector>

namespace mimetic {

/// A picture that lies on faces: rows x cols x 4, red, green, blue, opacity; the top row first.
struct Paint {
    int rows = 0;
    int cols = 0;
    std::vector<std::uint8_t> pixels;
};

/// What the faces of a mesh of V vertices show.
struct Paints {
    std::vector<Paint> pictures;
    Eigen::VectorXi picture_of_face;  ///< F
    Points2 corners;                  ///< 4F: where a face's corners lie in it, 0 to 1 from the bottom left
    Eigen::VectorXd brightness;       ///< V, 0 to 1: how much light reaches the place
};

struct PaintedOptions {
    int levels = 1;      ///< of subdivision, 0 to 5
    int finer = 2;       ///< samples a pixel on each axis, against steps at edges, 1 to 4
    double relief = .3;  ///< how much darker skin gets that is turned from the lamp, 0 to 1
    int ground = 60;     ///< grey where nothing is, 0 to 255
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// The limit surface of a painted mesh as a camera sees it, a frame at a time.
class PaintedSurface {
public:
    /// faces: quads of V vertices, each of which one uses. Throws InvalidInput.
    PaintedSurface(QuadsIn faces, Paints paints, const PaintedOptions& options = {});

    /// vertices_in_camera: V x 3, metres; light: of each picture, what its colours are multiplied by, all 1
    /// if it is empty. Faces that are turned away and those with a corner behind the camera are left out; of
    /// see-through ones the nearest is drawn. Throws InvalidInput on another number of vertices, or one that
    /// is not finite.
    ColorImage draw(const Camera& camera, PointsIn vertices_in_camera,
                    VectorIn light = Eigen::VectorXd()) const;

private:
    struct Layer;
    struct Placed;
    Placed place(const Camera& camera, PointsIn vertices_in_camera) const;
    void fill(Layer& covering, Layer& open, const Placed& placed) const;
    Eigen::Vector3f mean(const Layer& covering, const Layer& open, const Placed& placed, int x, int y) const;
    Eigen::Vector3f sample(const Layer& covering, const Layer& open, const Placed& placed, int x,
                           int y) const;
    Eigen::Vector4f colour(const Placed& placed, int half, const Eigen::Vector2f& last_weights) const;
    const std::uint8_t* texel(int face, int x, int y) const;

    Paints paints_;
    PaintedOptions options_;
    SubdividedMesh mesh_;
    Rows<float, 2> corners_;            // of refined faces, 4 each, in the paint's pixels
    Eigen::VectorXf brightness_;        // of refined vertices
    std::vector<bool> is_open_;         // of pictures: something in it is see-through
    std::vector<int> covering_, open_;  // refined vertices of faces that show opaque pictures, and others
};

}  // namespace mimetic
