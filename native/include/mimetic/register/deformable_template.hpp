// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

class MeshSurface;

/// Vertices of a template that was laid on a mesh, L of them.
struct LaidVertices {
    Points places;          ///< L x 3, metres, the mesh's frame
    Eigen::VectorXd sigma;  ///< L, m, standard deviation of each, by how the surface and the targets tell it
    double misfit = 0;      ///< 0 to 1, share of the face that does not lie on the mesh, within .7 mm half
};

/// A head that can be any person of an identity space, and departs from these smoothly: what lies between
/// landmarks says where they are. Laid on a mesh by rounds of closest points [Besl & McKay 1992; Amberg et
/// al. 2007], to planes and robust, with the modes' prior and the landmarks' own doubt.
class DeformableTemplate {
public:
    /// vertices: V x 3, metres, head frame; triangles: outward, of its skin; modes: K x 3V, metres; sigma: K,
    /// their standard deviations; is_face: V, which of the skin's vertices are drawn to a mesh, the face
    /// without sockets and mouth. Throws InvalidInput on sizes that differ, or no vertex of the face.
    DeformableTemplate(PointsIn vertices, TrianglesIn triangles, MatrixIn modes, VectorIn sigma,
                       const std::vector<bool>& is_face);

    /// Where vertices (L) lie after the face was laid on a mesh, about in its frame and of its size.
    /// vertices, normals: N x 3, triangles of the mesh; targets: L x 3, metres; sigma: L, m, of each
    /// coordinate. Throws InvalidInput on a vertex that there is not, a target that is not finite or a doubt
    /// that is not above zero.
    LaidVertices lay(const std::vector<int>& rows, PointsIn targets, VectorIn sigma, PointsIn vertices,
                     PointsIn normals, TrianglesIn triangles) const;

private:
    struct State;

    Eigen::Index num_unknowns() const;
    Points shape(const State& state) const;
    /// Adds what the mesh tells to the normal equations; returns the share of the face that does not lie on
    /// it.
    double add_surface(const State& state, const Points& shape, const MeshSurface& mesh, double reach,
                       Eigen::MatrixXd& normal, Eigen::VectorXd& gradient) const;
    /// L*3 x unknowns, how the vertices move.
    Eigen::MatrixXd motion(const State& state, const Points& shape, const std::vector<int>& rows) const;

    Points vertices_;
    Triangles triangles_;
    MatrixRows modes_;       // K x 3V, of one standard deviation
    Eigen::MatrixXd bumps_;  // V x B, of one standard deviation
    std::vector<int> face_;
};

}  // namespace mimetic
