// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/analyse/curve_edits.hpp>
#include <mimetic/analyse/delays.hpp>
#include <mimetic/analyse/group_curves.hpp>
#include <mimetic/analyse/phases.hpp>
#include <mimetic/analyse/sparse_curve.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_shape(py::module_& m) {
    py::enum_<PhaseModel>(m, "PhaseModel", "How an actuation rises and falls; see phases.hpp.")
        .value("linear_ramp", PhaseModel::linear_ramp)
        .value("one_exponential", PhaseModel::one_exponential)
        .value("two_exponentials", PhaseModel::two_exponentials);
    py::class_<PhaseShape>(m, "PhaseShape", "Application, hold, release and relaxation; times in frames.")
        .def(py::init<>())
        .def_readwrite("model", &PhaseShape::model)
        .def_readwrite("rest", &PhaseShape::rest)
        .def_readwrite("before", &PhaseShape::before,
                       "Level that it is applied from, if that is well above rest, or None.")
        .def_readwrite("amplitude", &PhaseShape::amplitude)
        .def_readwrite("onset", &PhaseShape::onset)
        .def_readwrite("rise", &PhaseShape::rise)
        .def_readwrite("hold", &PhaseShape::hold)
        .def_readwrite("drift", &PhaseShape::drift)
        .def_readwrite("exponent", &PhaseShape::exponent)
        .def_readwrite("release_time", &PhaseShape::release_time)
        .def_readwrite("relaxation_time", &PhaseShape::relaxation_time)
        .def_readwrite("relaxed_share", &PhaseShape::relaxed_share)
        .def_property_readonly("climb", &PhaseShape::climb)
        .def_property_readonly("apex", &PhaseShape::apex)
        .def_property_readonly("release", &PhaseShape::release)
        .def_property_readonly("fall_time", &PhaseShape::fall_time)
        .def(
            "values",
            [](const PhaseShape& shape, const Eigen::VectorXd& frames) {
                Eigen::VectorXd values(frames.size());
                for (Eigen::Index i = 0; i < frames.size(); ++i) {
                    values[i] = shape.value(frames[i]);
                }
                return values;
            },
            "frames"_a, "Values (N,) at frames (N,).");
}

void bind_fit(py::module_& m) {
    py::class_<Interval>(m, "Interval", "An estimate with its 95 % interval.")
        .def_readonly("value", &Interval::value)
        .def_readonly("lower", &Interval::lower)
        .def_readonly("upper", &Interval::upper);
    py::class_<PhaseFit>(m, "PhaseFit", "An event of a curve with its phases; see phases.hpp.")
        .def_readonly("shape", &PhaseFit::shape)
        .def_readonly("onset", &PhaseFit::onset)
        .def_readonly("apex", &PhaseFit::apex)
        .def_readonly("release", &PhaseFit::release)
        .def_readonly("amplitude", &PhaseFit::amplitude)
        .def_readonly("exponent", &PhaseFit::exponent)
        .def_readonly("release_time", &PhaseFit::release_time)
        .def_readonly("relaxation_time", &PhaseFit::relaxation_time)
        .def_readonly("relaxed_share", &PhaseFit::relaxed_share)
        .def_readonly("length", &PhaseFit::length)
        .def_readonly("bic", &PhaseFit::bic)
        .def_readonly("noise", &PhaseFit::noise)
        .def_readonly("smoothing", &PhaseFit::smoothing)
        .def_readonly("explained", &PhaseFit::explained)
        .def_readonly("linear_explained", &PhaseFit::linear_explained)
        .def_readonly("first", &PhaseFit::first)
        .def_readonly("last", &PhaseFit::last)
        .def_readonly("begins_before", &PhaseFit::begins_before)
        .def_readonly("ends_after", &PhaseFit::ends_after)
        .def_readonly("is_certain", &PhaseFit::is_certain);
    py::class_<PhaseOptions>(m, "PhaseOptions", "See phases.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("least_amplitude", &PhaseOptions::least_amplitude)
        .def_readwrite("least_drop", &PhaseOptions::least_drop)
        .def_readwrite("certainty", &PhaseOptions::certainty)
        .def_readwrite("robust_scale", &PhaseOptions::robust_scale)
        .def_readwrite("timing_std", &PhaseOptions::timing_std)
        .def_readwrite("measured_std", &PhaseOptions::measured_std)
        .def_readwrite("exponent_std", &PhaseOptions::exponent_std)
        .def_readwrite("shape_error", &PhaseOptions::shape_error)
        .def_readwrite("num_draws", &PhaseOptions::num_draws)
        .def_readwrite("seed", &PhaseOptions::seed)
        .def_readwrite("scene_starts", &PhaseOptions::scene_starts);
    py::class_<MeasuredCourses, std::shared_ptr<MeasuredCourses>>(
        m, "MeasuredCourses", "How muscles rise and fall by the pictures alone; see measured_courses.hpp.")
        .def(py::init<MatrixIn, const Eigen::Ref<const Rows<float, Eigen::Dynamic>>&>(), "activations"_a,
             "evidence"_a,
             "activations: (N, P); evidence: (N, E) float32, as `pack_evidence` has it. Raises InvalidInput.")
        .def("course", &MeasuredCourses::course, "members"_a, "first"_a, "last"_a, "top"_a,
             "Mean (last - first + 1,) of the members, (P,) of 0 and 1, in the proportions of row top.");
    m.def(
        "fit_phases",
        [](const Eigen::VectorXd& frames, const Eigen::VectorXd& values, const Eigen::VectorXd& stds,
           const std::vector<bool>& usable, const PhaseOptions& options,
           const std::optional<std::shared_ptr<MeasuredCourses>>& courses, const Eigen::VectorXd& members) {
            return fit_phases(frames, values, stds, usable, options,
                              {courses ? courses->get() : nullptr, members});
        },
        "frames"_a, "values"_a, "stds"_a, "usable"_a, "options"_a = PhaseOptions(), "courses"_a = py::none(),
        "members"_a = Eigen::VectorXd(), py::call_guard<py::gil_scoped_release>(),
        "Events of a curve (N,) at rising frames (N,) with their phases; usable (N,): false where a frame is "
        "held;\ncourses, members (P,): MeasuredCourses, and the muscles whose mean the curve is. Raises "
        "InvalidInput.");
}

void bind_delay(py::module_& m) {
    py::class_<Delay>(m, "Delay", "How much later an application comes; see delays.hpp.")
        .def_readonly("lag", &Delay::lag)
        .def_readonly("correlation", &Delay::correlation)
        .def_readonly("onset_lag", &Delay::onset_lag)
        .def_readonly("apex_lag", &Delay::apex_lag)
        .def_readonly("chance", &Delay::chance)
        .def_readonly("is_delayed", &Delay::is_delayed);
    py::class_<DelayOptions>(m, "DelayOptions", "See delays.hpp for each field.")
        .def(py::init<>())
        .def_readwrite("max_lag", &DelayOptions::max_lag)
        .def_readwrite("timing_std", &DelayOptions::timing_std)
        .def_readwrite("num_draws", &DelayOptions::num_draws)
        .def_readwrite("seed", &DelayOptions::seed)
        .def_readwrite("scene_starts", &DelayOptions::scene_starts);
    m.def("estimate_delay", &estimate_delay, "frames"_a, "leader"_a, "leader_fit"_a, "curve"_a, "fit"_a,
          "options"_a = DelayOptions(), py::call_guard<py::gil_scoped_release>(),
          "The Delay of an event of `curve` (N,) behind one of `leader` (N,), or None where there is nothing "
          "to\ncompare. Raises InvalidInput.");
}

void bind_sparse_curve(py::module_& m) {
    py::class_<SparseCurve>(m, "SparseCurve", "A curve by few keys with handles; see sparse_curve.hpp.")
        .def_readonly("frames", &SparseCurve::frames)
        .def_readonly("values", &SparseCurve::values)
        .def_readonly("slopes", &SparseCurve::slopes)
        .def_readonly("error", &SparseCurve::error)
        .def("value", &SparseCurve::value, "frame"_a);
    m.def("reduce_curve", &reduce_curve, "frames"_a, "values"_a, "tolerance"_a,
          py::call_guard<py::gil_scoped_release>(),
          "The SparseCurve that stays within the tolerance of a dense one (N,). Raises InvalidInput.");
    m.def("reduce_together", &reduce_together, "frames"_a, "values"_a, "tolerance"_a,
          py::call_guard<py::gil_scoped_release>(),
          "A SparseCurve of each column (N, C), all with keys at the same frames. Raises InvalidInput.");
    m.def(
        "reduce_by_phases",
        [](const Eigen::VectorXd& frames, const Eigen::VectorXd& values, const Eigen::VectorXd& stds,
           double tolerance) {
            PhaseKeys keys = reduce_by_phases(frames, values, stds, tolerance);
            return std::pair{std::move(keys.curve), std::move(keys.keys_of_event)};
        },
        "frames"_a, "values"_a, "stds"_a, "tolerance"_a, py::call_guard<py::gil_scoped_release>(),
        "The same with keys first at the phases of events, and how many keys each event has. Raises "
        "InvalidInput.");
}

void bind_curve_edits(py::module_& m) {
    m.def(
        "smooth_curve",
        [](const Eigen::VectorXd& frames, const Eigen::VectorXd& values, const Eigen::VectorXd& at,
           double width) {
            SmoothedCurve curve = smooth_curve(frames, values, at, width);
            return std::pair{std::move(curve.values), std::move(curve.slopes)};
        },
        "frames"_a, "values"_a, "at"_a, "width"_a, py::call_guard<py::gil_scoped_release>(),
        "Values and slopes (M,) at frames `at` (M,) of a curve (N,) smoothed by a width in frames; see "
        "curve_edits.hpp.\nRaises InvalidInput.");
    m.def(
        "smooth_keys",
        [](const Eigen::VectorXd& frames, const Eigen::VectorXd& values, const Eigen::VectorXd& keys,
           double width) {
            SmoothedCurve curve = smooth_keys(frames, values, keys, width);
            return std::pair{std::move(curve.values), std::move(curve.slopes)};
        },
        "frames"_a, "values"_a, "keys"_a, "width"_a, py::call_guard<py::gil_scoped_release>(),
        "Values at keys (K,), and the slopes whose cubics lie nearest to the smoothed curve between them. "
        "Raises InvalidInput.");
    m.def("retimed_frames", &retimed_frames, "frames"_a, "first"_a, "last"_a, "factor"_a,
          "Frames (N,) of which those from `first` to `last` take `factor` times as long. Raises "
          "InvalidInput.");
}

}  // namespace

void bind_analyse_phases(py::module_& m) {
    bind_sparse_curve(m);
    bind_curve_edits(m);
    bind_shape(m);
    bind_fit(m);
    bind_delay(m);
    py::class_<MeanCurves>(m, "MeanCurves", "Means of several curves; see group_curves.hpp.")
        .def_readonly("values", &MeanCurves::values)
        .def_readonly("stds", &MeanCurves::stds)
        .def_readonly("measured_std", &MeanCurves::measured_std);
    m.def("mean_curves", &mean_curves, "values"_a, "stds"_a, "members"_a,
          "MeanCurves (N, G) of columns (N, M) by members (G, M), 0 or 1. Raises InvalidInput.");
}

}  // namespace mimetic::bindings
