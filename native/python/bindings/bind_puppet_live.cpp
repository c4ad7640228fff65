// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/puppet/stillness.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_puppet_live(py::module_& m) {
    py::class_<StillnessFigures>(m, "StillnessFigures", "What a stillness costs and gives.")
        .def_readonly("lag_frames", &StillnessFigures::lag_frames,
                      "of a muscle that goes from 0 to .5 in a third of a second, at half its way")
        .def_readonly("jitter_share", &StillnessFigures::jitter_share,
                      "of a still face's jitter that remains, in standard deviations");
    m.def("stillness_figures", &stillness_figures, "stillness"_a, "fps"_a,
          "What a stillness costs and gives at a rate, by running the filter. Raises InvalidInput.");
    py::class_<StillnessFilter>(m, "StillnessFilter",
                                "Takes the jitter out of a live face; lags less the quicker it moves.")
        .def(py::init<double>(), "stillness"_a,
             "stillness: 0 least lag to 1 least jitter. Raises InvalidInput.")
        .def_property("stillness", &StillnessFilter::stillness, &StillnessFilter::set_stillness)
        .def(
            "advance",
            [](StillnessFilter& filter, const Eigen::Matrix4d& camera_from_head,
               const Eigen::VectorXd& values, double seconds) {
                const LivePose pose = filter.advance({to_isometry(camera_from_head), values}, seconds);
                return py::make_tuple(Eigen::Matrix4d(pose.camera_from_head.matrix()), pose.values);
            },
            "camera_from_head"_a, "values"_a, "seconds"_a,
            "The next frame's pose (4, 4) and values (M,); seconds: since the one before. Raises "
            "InvalidInput.");
}

}  // namespace mimetic::bindings
