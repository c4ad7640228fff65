// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <mimetic/surface/surface.hpp>
#include <string>
#include <vector>

namespace mimetic {

using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// The head whose mesh all fitted heads share, with what is known of its vertices by name. V control vertices
/// of the whole head, S of its skin (they come first), F faces. Metres, head frame.
struct TemplateMesh {
    Points vertices;            ///< V x 3
    Quads faces;                ///< F x 4, those of the skin first
    int num_skin_vertices = 0;  ///< S
    int num_skin_faces = 0;     ///< visible skin, linings of the mouth and of the eye sockets
    Eigen::VectorXi part;       ///< F, into part_names
    std::vector<std::string> part_names;
    Eigen::VectorXi region;  ///< S, into region_names
    std::vector<std::string> region_names;
    Eigen::VectorXi landmark_vertices;        ///< L
    std::vector<std::string> landmark_names;  ///< L, with .L and .R where there are two
    Points eye_centers;                       ///< 2 x 3, left first
    Points jaw_hinge;                         ///< 2 x 3, the condyles, left first

    void check() const;  ///< throws InvalidInput: which array does not fit the others
};

/// The template's skin, refined; made once for all heads.
class TemplateSkin {
public:
    /// Each face becomes 4: forehead faces of 13-23 mm are too coarse for a muscle 8 mm wide.
    static constexpr int kLevels = 1;

    explicit TemplateSkin(TemplateMesh mesh);  ///< throws InvalidInput as TemplateMesh::check

    const TemplateMesh& mesh() const { return mesh_; }
    const SubdividedMesh& refinement() const { return refinement_; }
    const Quads& outer_quads() const { return outer_quads_; }  ///< of the visible skin, control vertices

    bool has_landmark(const std::string& name) const;
    /// Vertex of a landmark, a paired one by its full name (mouth_corner.L). Throws InvalidInput.
    int landmark(const std::string& name) const;
    int part_number(const std::string& name) const;                 ///< into part_names; throws InvalidInput
    Flags in_region(const std::string& name) const;                 ///< S; throws InvalidInput
    std::vector<int> part_vertices(const std::string& name) const;  ///< rising; throws InvalidInput
    /// Control vertices that faces of both parts of the skin share, rising: the margin of the lids, of the
    /// lips. Throws InvalidInput.
    std::vector<int> vertices_between(const std::string& part, const std::string& other) const;

private:
    TemplateMesh mesh_;
    SubdividedMesh refinement_;
    Quads outer_quads_;
};

}  // namespace mimetic
