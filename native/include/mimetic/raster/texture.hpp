// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/raster/overlay.hpp>
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// Faces laid out in a square texture of `size` texels a side, 16 to 16384: quads F x 4 of V vertices and
/// their corners' coordinates in the square, 4 F x 2, 0 to 1 from the bottom left.
struct TextureLayout {
    Quads faces;
    Points2 corners;
    int size = 0;

    /// Throws InvalidInput: an unsupported size, an index out of range, corners that are missing or
    /// not finite.
    void check(Eigen::Index num_vertices) const;
};

/// Values at the vertices (V x K) as a picture, size^2 x K, first row on top: of each texel the mean over the
/// faces that overlap it, also in part; 0 where none does. Throws InvalidInput on
/// a layout that does not match, or that leaves the square.
MatrixRows unwrap_values(const TextureLayout& layout, MatrixIn values);

/// A texture with a frame's colours, and the skin's.
struct ProjectedTexture {
    ColorImage texture;
    Eigen::Vector3d median_colour;  ///< of what the frame shows, 0 to 255
};

/// Where the frame shows nothing, colours are interpolated smoothly from where it does. vertices_in_camera: V
/// x 3, metres; normals: V x 3, unit; layout: all faces, since each may occlude skin; its size is a power of
/// two; vertex_weights: V, 0 where the frame's colours are not wanted to 1. Throws InvalidInput if the face
/// is outside the picture.
ProjectedTexture project_texture(const Camera& camera, const ColorView& image, PointsIn vertices_in_camera,
                                 PointsIn normals, const TextureLayout& layout, VectorIn vertex_weights);

}  // namespace mimetic
