// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <mimetic/shared/similarity.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

using LongQuads = Rows<std::int64_t, 4>;

/// Triangles of a mesh, and which of its faces each is a part of.
struct CutFaces {
    Triangles triangles;
    Eigen::VectorXi face;
};

/// Triangles of triangles and quads (F x 4, a triangle ends below 0); a quad is cut along its shorter
/// diagonal. Throws InvalidInput, naming the face, on a vertex that the mesh does not have.
CutFaces cut_faces(PointsIn points, const Eigen::Ref<const LongQuads>& faces);

/// Triangles and quads (F x 4, a triangle ends in -1) of polygons, and the polygon of each.
struct PolygonPieces {
    LongQuads faces;
    Eigen::VectorXi polygon;
};

/// Polygons of five corners and more are cut into triangles from the corner that leaves no sliver: the
/// smallest triangle is the largest it can be. starts: the first corner of each; corners: vertices. Throws
/// InvalidInput on polygons of fewer than three corners and on vertices that do not exist.
PolygonPieces cut_polygons(PointsIn points, const std::vector<std::int64_t>& starts,
                           const std::vector<std::int64_t>& corners);

/// An object's mesh in metres.
struct PlacedMesh {
    Points vertices;                   ///< V x 3
    LongQuads faces;                   ///< reversed if the object is mirrored, which inverts its faces
    Eigen::Matrix3d object_from_head;  ///< of displacements
};

/// points: V x 3 and faces (F x 4) of the object. Throws InvalidInput if it is scaled to nothing.
PlacedMesh place_mesh(PointsIn points, const Eigen::Ref<const LongQuads>& faces,
                      const Eigen::Matrix4d& metres_from_object);

/// The skin of a head's mesh that is not the template's: the connected part that its landmarks lie on, in the
/// template's frame and size, vertices at exactly the same place joined.
struct ForeignSkin {
    Points vertices;              ///< N x 3, metres
    Triangles triangles;          ///< T x 3
    Eigen::VectorXi face;         ///< T, the caller's face of each
    Points landmarks;             ///< L x 3
    Eigen::VectorXi skin_vertex;  ///< V, of each of the caller's vertices; -1 on loose parts
    Points user_vertices;         ///< V x 3, all of the caller's vertices
    Eigen::VectorXi loose;        ///< V, the number of the loose part; -1 on the skin
    int num_collapsed = 0;        ///< faces without extent that were left out
};

/// Landmarks placed on a face.
struct NamedPlaces {
    std::vector<std::string> names;
    Points places;           ///< L x 3, metres, the mesh's coordinates
    std::vector<int> front;  ///< of them, those whose skin faces forwards on any face
};

/// Throws InvalidInput, naming face, vertex or landmark as the caller does, on a landmark that lies off the
/// skin, skin of too many vertices, a face without area, faces oriented inwards. points: V x 3, metres.
ForeignSkin read_foreign_skin(PointsIn points, const CutFaces& faces, const NamedPlaces& landmarks,
                              const Similarity& user_from_skin);

/// A face (the caller's) beside each hole in free skin that is not the largest opening and lies farther from
/// all `places` (K x 3, metres) than its reach. free: N.
std::vector<int> find_holes(const ForeignSkin& skin, const std::vector<bool>& free, PointsIn places,
                            VectorIn reaches);

/// Vertices of the seam of a mouth that is not cut open, N; none if the mouth is open. inner: 2 x 3, the
/// inner edge of the upper and of the lower lip; corners: 2 x 3, of the mouth.
std::vector<bool> find_seam(PointsIn vertices, TrianglesIn triangles, PointsIn inner, PointsIn corners);

}  // namespace mimetic
