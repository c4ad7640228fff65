// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <mimetic/raster/quad_edges.hpp>
#include <mimetic/shared/camera.hpp>
#include <vector>

namespace mimetic {

/// Places in a picture: 0 to 1 from edge to edge, from the bottom left, as graphics hardware takes them.
using PicturePlaces = Rows<float, 2>;

/// What is seen of a face in one frame.
struct DrawnLines {
    PicturePlaces mesh;             ///< 2K: ends of edges that face the camera and nothing covers
    PicturePlaces features;         ///< 2K: ends of the feature lines' parts that nothing covers
    PicturePlaces rings;            ///< 2K: of the rings
    PicturePlaces marks;            ///< P: all of them, wherever they are; not a number behind the camera
    std::vector<bool> marks_shown;  ///< P: in the picture and not covered
};

/// The limit surface of a face that moves by modes, as lines over its footage, a frame at a time: the limit
/// is linear, so it is taken of neutral and modes once.
class FaceLines {
public:
    /// What of the face is drawn; faces of the control mesh, vertices of it.
    struct Parts {
        std::vector<bool> is_shown;              ///< F: faces that are drawn and cover others
        std::vector<std::vector<int>> features;  ///< lines of vertices
        std::vector<int> marks;                  ///< P vertices
    };

    /// neutral: V x 3, metres, head frame; modes: M x 3V (x, y, z of each vertex in turn), metres at the
    /// value 1; faces: of V vertices, each of which one uses. Throws InvalidInput.
    FaceLines(const Camera& camera, PointsIn neutral, MatrixIn modes, QuadsIn faces, const Parts& parts);

    /// values: M; rings: closed lines (K x 3, metres, head frame), drawn where no skin covers them.
    DrawnLines draw(VectorIn values, const Eigen::Isometry3d& camera_from_head,
                    const std::vector<Points>& rings = {}) const;

    Eigen::Index num_values() const { return modes_.rows(); }

private:
    Points in_camera(VectorIn values, const Eigen::Isometry3d& camera_from_head) const;

    Camera camera_;
    Points neutral_;  // limit, W x 3 of the vertices that something drawn uses
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> modes_;  // limit, M x 3W
    QuadEdges mesh_;
    std::vector<std::vector<int>> features_;
    std::vector<int> marks_;
};

}  // namespace mimetic
