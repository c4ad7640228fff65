// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/skin/skin.hpp>

namespace mimetic {

/// Material parameters of skin by regions of the template: data/materials.toml.
struct MaterialTable {
    /// In the order of SkinMaterials: young, poisson, thickness, pre_stress, tangential, normal; its units.
    using Values = std::array<double, 6>;

    Values base;
    std::map<std::string, Values> regions;  ///< factors
    double lid_reach = 5e-3;                ///< m: the lids are held within this of their edge
    double lid_attachment = 20;             ///< times both attachments there
};

/// Skin of a head on its bones: N vertices of its own mesh, which N x S stencils make of S control vertices
/// (on a mesh that is not the template's, of the vertices themselves); the U free ones are the unknowns of
/// the model.
class AttachedSkin {
public:
    /// stencils: N x S; free: S, the others are held. Throws InvalidInput where sizes disagree.
    AttachedSkin(PointsIn vertices, TrianglesIn triangles, SkinMaterials materials,
                 const SparseRows& stencils, Flags free);

    /// A person's skin on the template's mesh. stiffness: N, times the attachment to the bone.
    AttachedSkin(const SkinMesh& mesh, const MaterialTable& table, VectorIn stiffness);

    const Flags& free() const { return free_; }
    const SparseRows& basis() const { return basis_; }  ///< N x U
    const SkinMaterials& materials() const { return materials_; }
    const SkinModel& model() const;  ///< factored when first asked for; throws InvalidInput as SkinModel does

    /// Forces on the vertices, M x 3N newtons -> displacements of the control vertices, M x 3S metres.
    MatrixRows respond(MatrixIn forces) const;
    /// The same for loads on the unknowns, 3U x M.
    MatrixRows respond_to_loads(const Eigen::Ref<const Eigen::MatrixXd>& loads) const;
    /// Unknowns, 3U x M -> displacements of all control vertices, M x 3S.
    MatrixRows on_control_vertices(const Eigen::Ref<const Eigen::MatrixXd>& unknowns) const;
    /// Forces of the attachment when the bone under the skin moves: M x 3N metres -> M x 3N newtons.
    MatrixRows foundation_forces(MatrixIn displacements) const;

private:
    Points vertices_;
    Triangles triangles_;
    SkinMaterials materials_;
    Flags free_;
    SparseRows basis_;
    Lazy<SkinModel> model_;
};

/// A matrix without the columns that are not kept.
SparseRows keep_columns(const SparseRows& matrix, const Flags& kept);

/// Some rows of a matrix, in their order.
SparseRows keep_rows(const SparseRows& matrix, const std::vector<int>& rows);

/// A muscle of data/muscles.toml: one of the left and one of the right side.
struct MuscleEntry {
    std::string name;
    MuscleType type = MuscleType::linear;
    std::vector<LandmarkPlace> insertion;
    LandmarkPlace origin;       ///< on the bone; a sphincter has none
    double width = 6;           ///< mm on the template
    double normal_share = 0.1;  ///< as in Muscle, likewise those below
    double protrusion = 0;
    double swelling = 0;
    LandmarkPlace measured_at;  ///< the place whose motion sets the strength
    double excursion = 0;       ///< mm on the template, its motion at activation 1
};

/// A muscle on a head.
struct PlacedMuscle {
    std::string name;  ///< without side
    Muscle muscle;
    std::string anchor;  ///< the landmark at which its excursion is measured
    Place measured;
    double excursion = 0;  ///< metres on this head
};

/// The muscles on a head of the template's mesh, left and right of each entry in turn. canonical: the
/// template's own skin; shifts_mm: M x 2 of the insertions along the skin, away from the midline and up.
std::vector<PlacedMuscle> place_muscles(const SkinMesh& canonical, const SkinMesh& mesh,
                                        const std::vector<MuscleEntry>& table, Points2In shifts_mm);

/// One of them: muscle i is entry i / 2 on side "LR"[i % 2].
PlacedMuscle place_muscle(const SkinMesh& canonical, const SkinMesh& mesh, const MuscleEntry& entry,
                          char side, const Eigen::RowVector2d& shift_mm);

/// Forces of M muscles on a skin, and its response.
struct Pulled {
    MatrixRows forces;          ///< M x 3N at unit strength
    MatrixRows responses;       ///< M x 3S, metres, of the control vertices to them
    Eigen::VectorXd strengths;  ///< M, newtons (sphincters: newtons a metre)
};

/// Each with the strength that gives its excursion. surface: of the skin's mesh; measured: M x S, rows that
/// read the motion of each muscle's measured place. Throws InvalidInput, naming it, on a place that does not
/// move.
Pulled pull(const AttachedSkin& skin, const MuscleSurface& surface, const std::vector<PlacedMuscle>& muscles,
            const SparseRows& measured);

/// On a head of the template's mesh: rows of the stencils at the measured places.
SparseRows measured_rows(const SkinMesh& mesh, const std::vector<PlacedMuscle>& muscles);

/// Motion of the place that row `index` of `measured` reads, in a response (3S).
Eigen::RowVector3d motion_at(const SparseRows& measured, Eigen::Index index,
                             const Eigen::Ref<const Eigen::RowVectorXd>& response);

/// Throws InvalidInput unless there is a row for each of `count` places, over the skin's control vertices.
void check_measured(const SparseRows& measured, Eigen::Index count, const AttachedSkin& skin);

/// Throws InvalidInput, naming both, unless the place by which a muscle is measured moves (metres).
void check_moves(double moved, const std::string& name, const std::string& anchor);

/// A head for the jaw's motions, of the template's mesh or any other: its attached skin's N vertices, and its
/// own V.
struct HeadOnJaw {
    Points skin;                 ///< N x 3
    Eigen::VectorXd influence;   ///< N, of the jaw on the bone under the skin, 0 to 1
    Points vertices;             ///< V x 3
    Eigen::VectorXi moves_with;  ///< V: the skin's control vertex that each goes with, -1 for none
    std::vector<int> rigid;      ///< of V: those fixed to the bone, teeth and tongue
};

/// That of a head of the template's mesh.
HeadOnJaw head_on_jaw(const std::shared_ptr<const SkinMesh>& mesh, const Jaw& jaw);

/// Displacement of the bone under the skin in the jaw's three motions at value 1, 3 x 3N.
MatrixRows jaw_under_skin(const Jaw& jaw, const HeadOnJaw& head);

/// Motions of a skin in the jaw's three (3 x 3S) as modes of the whole head, 3 x 3V.
MatrixRows jaw_on_head(const MatrixRows& on_skin, const Jaw& jaw, const HeadOnJaw& head);

/// Modes of the jaw's three motions over the whole head, 3 x 3V: the attachments to the bone move with it,
/// the skin follows.
MatrixRows jaw_modes(const AttachedSkin& skin, const Jaw& jaw, const HeadOnJaw& head);

/// Modes of upper and lower lid of the left and of the right eye over the whole head, 4 x 3V.
MatrixRows lid_modes(const std::shared_ptr<const SkinMesh>& mesh);

}  // namespace mimetic
