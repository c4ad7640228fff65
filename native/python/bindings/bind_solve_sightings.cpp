// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/solve/evidence.hpp>
#include <mimetic/solve/relief.hpp>
#include <optional>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;
using release_gil = py::call_guard<py::gil_scoped_release>;

namespace {

Sighting sighting_from_arrays(int frame, const Eigen::Matrix4d& pose, Eigen::VectorXd values,
                              const Triangles& vertices, const Points& barycentric, const Points2& pixels,
                              const DoubleArray& information) {
    const auto squares = matrices_of<2, 2>(information, "information");
    Rows<double, 4> rows(static_cast<Eigen::Index>(squares.size()), 4);
    for (std::size_t k = 0; k < squares.size(); ++k) {
        const Eigen::Matrix2d& square = squares[k];
        rows.row(static_cast<Eigen::Index>(k)) << square(0, 0), square(0, 1), square(1, 0), square(1, 1);
    }
    Sighting sighting{frame, to_isometry(pose), std::move(values), vertices, barycentric, pixels, rows, 0};
    sighting.check();
    return sighting;
}

void bind_points(py::module_& m) {
    py::class_<FittedSkin>(m, "FittedSkin",
                           "A fitted head's skin at rest: S control vertices, R refined ones.")
        .def(py::init([](const SubdividedMesh& surface, const Points& neutral, const Camera& camera,
                         const Eigen::Matrix4d& reference_pose) {
                 return FittedSkin(surface, neutral, camera, to_isometry(reference_pose));
             }),
             "surface"_a, "neutral"_a, "camera"_a, "reference_pose"_a,
             "neutral: (S, 3), metres, head frame; camera: of the footage; reference_pose: (4, 4), camera "
             "from "
             "head in\nthe fitted frame. Raises InvalidInput.")
        .def("rays_to", &FittedSkin::rays_to, "vertices"_a,
             "(K, 3): unit vectors from the fitted frame's camera to control vertices, head frame. Raises "
             "InvalidInput.");
    py::class_<Sighting>(m, "Sighting",
                         "K points of the skin in one frame, and the state that the capture gave it.")
        .def(
            py::init(&sighting_from_arrays), "frame"_a, "camera_from_head"_a, "values"_a, "vertices"_a,
            "barycentric"_a, "pixels"_a, "information"_a,
            "frame: number in the footage; camera_from_head: (4, 4), metres; values: (M,); vertices: (K, 3), "
            "refined\n"
            "vertices around each point; barycentric: (K, 3); pixels: (K, 2), by flow alone; information: "
            "(K, 2, 2),\npixels^-2. Raises InvalidInput.")
        .def_static(
            "of", &make_sighting, "frame"_a, "estimate"_a, "seen"_a, "outline"_a = SkinObservations{},
            "Of a frame that a tracker has just advanced to: at most 350 of its points, spread evenly, then "
            "the\nface's outline in it.")
        .def_readonly("frame", &Sighting::frame)
        .def_property_readonly("camera_from_head",
                               [](const Sighting& one) { return MatrixRows(one.camera_from_head.matrix()); })
        .def_readonly("values", &Sighting::values)
        .def_readonly("vertices", &Sighting::vertices)
        .def_readonly("barycentric", &Sighting::barycentric)
        .def_readonly("pixels", &Sighting::pixels)
        .def_readonly("num_outline", &Sighting::num_outline, "how many of the points, the last, are of it");
}

void bind_relief(py::module_& m) {
    py::class_<Relief>(m, "Relief", "How the depth of a fitted head differs.")
        .def_readonly("coefficients", &Relief::coefficients, "(C + K,), of components, then bumps")
        .def_readonly("depth_std", &Relief::depth_std,
                      "one a point of `judged`, metres: of its depth beside the mean of `spread`");
    m.def(
        "find_relief",
        [](const FittedSkin& skin, const ModesArray& components, const MatrixRows& bumps,
           const ModesArray& modes, const Eigen::VectorXd& std, std::vector<int> landmarks,
           std::vector<int> spread, std::vector<int> judged, const Eigen::VectorXd& start,
           const std::vector<Sighting>& sightings, const std::optional<Progress>& progress) {
            const Eigen::Index count = skin.neutral.rows();
            const auto components_in = view_modes("components", components, count);
            const auto modes_in = view_modes("modes", modes, count);
            const py::gil_scoped_release release;
            const ReliefModel model{
                components_in,     bumps, modes_in, std, std::move(landmarks), std::move(spread),
                std::move(judged), start};
            return find_relief(skin, model, sightings, {}, progress.value_or(Progress{}));
        },
        "skin"_a, py::arg("components").noconvert(), "bumps"_a, py::arg("modes").noconvert(), "std"_a,
        "landmarks"_a, "spread"_a, "judged"_a, "start"_a, "sightings"_a, "progress"_a = py::none(),
        "Relief: coefficients of the components, then the bumps, by which the depth of the head differs "
        "from the\nfitted one's, `start` included; none when progress says to stop.\n\n"
        "components: (C, S, 3) float64, metres at a standard deviation; bumps: (K, S), heights along the "
        "fitted\nframe's rays, metres at a standard deviation; modes: (M, S, 3) and std: (M,), prior, of "
        "the muscles and\narticulators with which the head was followed; landmarks, spread: control "
        "vertices that the fitted frame\nheld, and others over the face; judged: those whose depth's "
        "standard deviation is told; start: (C + K,), those that the "
        "skin has already. Raises InvalidInput.");
}

void bind_evidence(py::module_& m) {
    py::class_<WhitenedSighting>(
        m, "WhitenedSighting",
        "A sighting with pose and smooth model error eliminated, noise of unit variance.")
        .def(py::init([](const FittedSkin& skin, const Sighting& sighting, const ModesArray& modes) {
                 const auto modes_in = view_modes("modes", modes, skin.neutral.rows());
                 const py::gil_scoped_release release;
                 return WhitenedSighting(skin, sighting, modes_in);
             }),
             "skin"_a, "sighting"_a, py::arg("modes").noconvert(),
             "modes: (M, S, 3) float64, metres, those that the capture used. Raises InvalidInput.");
    py::class_<LinearFrame>(m, "LinearFrame",
                            "A frame's normal equations in the modes and their derivatives by parameters.")
        .def(py::init([](const FittedSkin& skin, const WhitenedSighting& seen, const ModesArray& columns,
                         const Eigen::VectorXd& std, double at_rest) {
                 const auto columns_in = view_modes("columns", columns, skin.neutral.rows());
                 const py::gil_scoped_release release;
                 return LinearFrame(skin, seen, columns_in, std, at_rest);
             }),
             "skin"_a, "seen"_a, py::arg("columns").noconvert(), "std"_a, "at_rest"_a,
             "columns: (A, M, S, 3) float64, metres: the modes, then their derivatives by each parameter; "
             "std: "
             "(M,),\n"
             "priors of the values; at_rest: values nearer to 0 in this frame count as 0. Raises "
             "InvalidInput.");
    py::class_<SkinFactors>(
        m, "SkinFactors",
        "Factors on a person's skin and muscles as one vector: logarithms of the stiffness by "
        "region and of\nthe strength of strong muscles, then their insertions outwards and up "
        "in units of INSERTION_UNIT mm.")
        .def(py::init([](int num_regions, std::vector<int> strong, int num_values) {
                 SkinFactors factors{num_regions, std::move(strong), num_values};
                 factors.check();
                 return factors;
             }),
             "num_regions"_a, "strong"_a, "num_values"_a,
             "strong: indices of the muscles active in the clip; num_values: muscles and articulators")
        .def_property_readonly("strong", [](const SkinFactors& one) { return one.strong; })
        .def_readonly("stiffness_std", &SkinFactors::stiffness_std, "prior, of the logarithm")
        .def_property_readonly("prior_std", &SkinFactors::prior_std, "(P,), about 0")
        .def_readonly_static("INSERTION_UNIT", &SkinFactors::kInsertionUnit, "mm");
    py::class_<Peak>(m, "Peak", "A maximum: where, standard deviations from the curvature there, the value.")
        .def_readonly("place", &Peak::place)
        .def_readonly("std", &Peak::std)
        .def_readonly("height", &Peak::height);
    m.def(
        "most_probable",
        [](std::vector<LinearFrame> frames, const SkinFactors& factors, const Eigen::VectorXd& base,
           double bound, const std::optional<Progress>& progress) {
            const SkinEvidence evidence(std::move(frames), factors, base);
            const auto height = [&](const Eigen::VectorXd& place) { return evidence.log_probability(place); };
            return std::pair(maximise(height, base, bound, progress.value_or(Progress{})), height(base));
        },
        "frames"_a, "factors"_a, "base"_a, "bound"_a, "progress"_a = py::none(), release_gil(),
        "(Peak, height of base): the factors within `bound` of base with the largest posterior, "
        "priors\nincluded. base: (P,), about which the modes were linearised. Raises InvalidInput.");
}

}  // namespace

void bind_solve_sightings(py::module_& m) {
    bind_points(m);
    bind_relief(m);
    bind_evidence(m);
}

}  // namespace mimetic::bindings
