// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/attach.hpp>
#include <optional>

#include "compressed_rows.hpp"
#include "stacks.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;
using MeshPointer = std::shared_ptr<SkinMesh>;

namespace {

/// An N x N identity where no stencils are given: the mesh's vertices are its control vertices.
SparseRows stencils_of(const std::optional<CompressedRows>& stencils, Eigen::Index num_vertices,
                       Eigen::Index num_control) {
    if (stencils) {
        if (stencils->matrix.cols() != num_control) {
            throw InvalidInput("stencils have " + std::to_string(stencils->matrix.cols()) + " columns for " +
                               std::to_string(num_control) + " control vertices");
        }
        return stencils->matrix;
    }
    SparseRows identity(num_vertices, num_vertices);
    identity.setIdentity();
    return identity;
}

void bind_skin_on_bones(py::module_& m) {
    py::class_<MaterialTable>(m, "MaterialTable",
                              "Material parameters of skin by regions: data/materials.toml.")
        .def(
            py::init([](const MaterialTable::Values& base,
                        const std::map<std::string, MaterialTable::Values>& regions, double lid_reach,
                        double lid_attachment) {
                return MaterialTable{base, regions, lid_reach, lid_attachment};
            }),
            py::kw_only(), "base"_a, "regions"_a, "lid_reach"_a, "lid_attachment"_a,
            "base, regions: values and factors of young, poisson, thickness, pre_stress, tangential, normal");
    py::class_<AttachedSkin>(m, "AttachedSkin", "Skin of a head on its bones, factored when first asked.")
        .def(py::init([](const MeshPointer& mesh, const MaterialTable& table, VectorIn stiffness) {
                 return std::make_unique<AttachedSkin>(*mesh, table, stiffness);
             }),
             "mesh"_a, "table"_a, "stiffness"_a, release_gil(),
             "A person's, on the template's mesh. stiffness: (N,), times the attachment to the bone.")
        .def(py::init([](PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                         const Flags& free, const std::optional<CompressedRows>& stencils) {
                 return std::make_unique<AttachedSkin>(vertices, triangles, materials,
                                                       stencils_of(stencils, vertices.rows(), free.size()),
                                                       free);
             }),
             py::arg("vertices").noconvert(), py::arg("triangles").noconvert(), "materials"_a, "free"_a,
             "stencils"_a = py::none(), release_gil(),
             "Any head's own. vertices: (N, 3); triangles: (T, 3); free: (S,) bool, the others are held;\n"
             "stencils: CompressedRows (N, S), none if the vertices are their own control vertices")
        .def_property_readonly("free", &AttachedSkin::free, "(S,) bool")
        .def_property_readonly(
            "basis", [](const AttachedSkin& skin) { return CompressedRows{skin.basis()}; },
            "Compressed rows of the (N, U) matrix from the unknowns of the model.")
        .def(
            "basis_at",
            [](const AttachedSkin& skin, const std::vector<int>& vertices) {
                return CompressedRows{keep_rows(skin.basis(), vertices)};
            },
            "vertices"_a, "The rows of the basis for some vertices.")
        .def_property_readonly("materials", &AttachedSkin::materials)
        .def_property_readonly(
            "model",
            [](const AttachedSkin& skin) -> const SkinModel& {
                const py::gil_scoped_release release;
                return skin.model();
            },
            py::return_value_policy::reference_internal)
        .def(
            "respond",
            [](const AttachedSkin& skin, const DoubleArray& forces) {
                const auto rows = stack_of(forces, "forces");
                MatrixRows response;
                {
                    const py::gil_scoped_release release;
                    response = skin.respond(rows);
                }
                return array_of_stack(std::move(response));
            },
            "forces"_a, "(M, N, 3) newtons -> displacements of the control vertices, (M, S, 3).")
        .def(
            "foundation_forces",
            [](const AttachedSkin& skin, const DoubleArray& displacements) {
                return array_of_stack(skin.foundation_forces(stack_of(displacements, "displacements")));
            },
            "displacements"_a, "(M, N, 3) metres of the bone under the skin -> newtons on the skin.");
}

void bind_entries(py::module_& m) {
    py::class_<LandmarkPlace>(m, "LandmarkPlace", "A place by a landmark of the template.")
        .def(py::init([](std::string anchor, double x, double y, double depth) {
                 return LandmarkPlace{std::move(anchor), x, y, depth};
             }),
             "anchor"_a, "x"_a, "y"_a, "depth"_a = 0.0, "x, y, depth: mm");
    py::class_<MuscleEntry>(m, "MuscleEntry", "A muscle of data/muscles.toml, left and right.")
        .def(py::init([](std::string name, MuscleType type, std::vector<LandmarkPlace> insertion,
                         const LandmarkPlace& origin, double width, double normal_share, double protrusion,
                         double swelling, const LandmarkPlace& measured_at, double excursion) {
                 return MuscleEntry{std::move(name), type,         std::move(insertion), origin,
                                    width,           normal_share, protrusion,           swelling,
                                    measured_at,     excursion};
             }),
             py::kw_only(), "name"_a, "type"_a, "insertion"_a, "origin"_a, "width"_a, "normal_share"_a,
             "protrusion"_a, "swelling"_a, "measured_at"_a, "excursion"_a, "width, excursion: mm");
    py::class_<PlacedMuscle>(m, "PlacedMuscle", "A muscle on a head.")
        .def_readonly("name", &PlacedMuscle::name, "without side")
        .def_readonly("muscle", &PlacedMuscle::muscle)
        .def_readonly("measured", &PlacedMuscle::measured, "Place whose motion sets its strength")
        .def_readonly("excursion", &PlacedMuscle::excursion, "metres on this head")
        .def(
            "carried",
            [](PlacedMuscle placed, PointsIn insertion) {
                placed.muscle.insertion = insertion;
                placed.muscle.check();
                return placed;
            },
            "insertion"_a, "The same muscle with its insertion (K, 3) on another skin.");
}

void bind_pull(py::module_& m) {
    py::class_<Pulled>(m, "Pulled", "Forces of M muscles on a skin, and its response.")
        .def_property_readonly(
            "forces", [](const Pulled& p) { return array_of_stack(p.forces); }, "(M, N, 3) at unit strength")
        .def_property_readonly(
            "responses", [](const Pulled& p) { return array_of_stack(p.responses); }, "(M, S, 3), metres")
        .def_readonly("strengths", &Pulled::strengths, "(M,), newtons (sphincters: newtons a metre)");
    m.def("place_muscles", &place_muscles, "canonical"_a, "mesh"_a, "table"_a, "shifts_mm"_a, release_gil(),
          "The muscles on a head of the template's mesh, left and right of each entry in turn.\n\n"
          "canonical: the template's own skin; shifts_mm: (M, 2) of the insertions along the skin, away from "
          "the\nmidline and up");
    m.def(
        "pull",
        [](const AttachedSkin& skin, const MuscleSurface& surface, const std::vector<PlacedMuscle>& muscles,
           const CompressedRows& measured) { return pull(skin, surface, muscles, measured.matrix); },
        "skin"_a, "surface"_a, "muscles"_a, "measured"_a, release_gil(),
        "Each muscle with the strength that gives its excursion.\n\n"
        "measured: CompressedRows (M, S) that read the motion of each muscle's measured place\n"
        "raises InvalidInput, naming it, on a place that does not move");
    m.def(
        "pull_person",
        [](const AttachedSkin& skin, const MeshPointer& mesh, const std::vector<PlacedMuscle>& muscles) {
            return pull(skin, mesh->surface(), muscles, measured_rows(*mesh, muscles));
        },
        "skin"_a, "mesh"_a, "muscles"_a, release_gil(), "The same on a head of the template's mesh.");
    m.def(
        "spread",
        [](const DoubleArray& modes, const Eigen::VectorXi& moves_with) {
            return array_of_stack(spread(stack_of(modes, "modes"), moves_with));
        },
        "modes"_a, "moves_with"_a,
        "From a skin, (M, S, 3), to a whole head, (M, V, 3).\n\n"
        "moves_with: (V,), the skin's vertex that each goes with, -1 for none. Raises InvalidInput.");
    m.def(
        "followed_vertices", [](const MeshPointer& mesh) { return followed_vertices(mesh); }, "mesh"_a,
        "(V,) of a head of the template's mesh, for `spread`: lashes go with their roots.");
    py::class_<HeadOnJaw>(m, "HeadOnJaw",
                          "A head for the jaw's motions: its skin's N vertices, and its own V.")
        .def(py::init([](Points skin, Eigen::VectorXd influence, Points vertices, Eigen::VectorXi moves_with,
                         std::vector<int> rigid) {
                 return HeadOnJaw{std::move(skin), std::move(influence), std::move(vertices),
                                  std::move(moves_with), std::move(rigid)};
             }),
             py::kw_only(), "skin"_a, "influence"_a, "vertices"_a, "moves_with"_a, "rigid"_a,
             "skin: (N, 3); influence: (N,), of the jaw on the bone under it, 0 to 1; vertices: (V, 3);\n"
             "moves_with: (V,), as `spread` has it; rigid: vertices that are fixed to the bone")
        .def_static(
            "of", [](const MeshPointer& mesh, const Jaw& jaw) { return head_on_jaw(mesh, jaw); }, "mesh"_a,
            "jaw"_a, "That of a head of the template's mesh.");
    m.def(
        "jaw_modes",
        [](const AttachedSkin& skin, const Jaw& jaw, const HeadOnJaw& head) {
            MatrixRows modes;
            {
                const py::gil_scoped_release release;
                modes = jaw_modes(skin, jaw, head);
            }
            return array_of_stack(std::move(modes));
        },
        "skin"_a, "jaw"_a, "head"_a,
        "(3, V, 3): the attachments to the bone move with it, the skin follows. Raises InvalidInput.");
    m.def(
        "jaw_on_head",
        [](const DoubleArray& on_skin, const Jaw& jaw, const HeadOnJaw& head) {
            return array_of_stack(jaw_on_head(stack_of(on_skin, "on_skin"), jaw, head));
        },
        "on_skin"_a, "jaw"_a, "head"_a, "The same where the skin's motions are known, (3, S, 3).");
    m.def(
        "lid_modes",
        [](const MeshPointer& mesh) {
            MatrixRows modes;
            {
                const py::gil_scoped_release release;
                modes = lid_modes(mesh);
            }
            return array_of_stack(std::move(modes));
        },
        "mesh"_a, "(4, V, 3): upper and lower lid of the left and of the right eye at value 1.");
}

}  // namespace

void bind_muscles_attach(py::module_& m) {
    bind_skin_on_bones(m);
    bind_entries(m);
    bind_pull(m);
}

}  // namespace mimetic::bindings
