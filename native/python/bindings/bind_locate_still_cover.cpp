// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/still_cover.hpp>
#include <optional>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

void bind_locate_still_cover(py::module_& m) {
    py::class_<StillCover>(m, "StillCover",
                           "What is before the face and stays where it is in the picture, by cells of it.")
        .def(py::init([](const Eigen::Vector2d& corner, double cell, const StillCover::Cells& cells) {
                 StillCover cover{corner, cell, cells};
                 cover.check();
                 return cover;
             }),
             "corner"_a, "cell"_a, "cells"_a,
             "corner: (2,), top left of the first cell, pixels; cell: its side, pixels; cells: (R, C) bool, "
             "rows\n"
             "downward. Raises InvalidInput.")
        .def_property_readonly(
            "corner", [](const StillCover& c) { return c.corner; }, "(2,) pixels")
        .def_readonly("cell", &StillCover::cell, "side of a cell, pixels")
        .def_property_readonly(
            "cells", [](const StillCover& c) { return c.cells; }, "(R, C) bool, from the top left")
        .def(
            "at",
            [](const StillCover& self, const Points2& pixels) {
                Eigen::Matrix<bool, Eigen::Dynamic, 1> is_there(pixels.rows());
                for (Eigen::Index i = 0; i < pixels.rows(); ++i)
                    is_there[i] = self.at(pixels.row(i).transpose());
                return is_there;
            },
            "pixels"_a, "(K,) bool: whether it is at pixels (K, 2) of the picture");
    py::class_<StillCoverWatch>(m, "StillCoverWatch",
                                "Finds what stands still in the picture before a face that moves.")
        .def(py::init<>())
        .def(
            "add",
            [](StillCoverWatch& self, const ImageArray& image, const FaceFeatures& face) {
                const ColorView view = view_image<3>(image, "image");
                py::gil_scoped_release release;
                self.add(view, face);
            },
            py::arg("image").noconvert(), "face"_a,
            "A frame, some of a clip's of one size, and the face that was found in it.\n\nimage: (H, W, 3) "
            "uint8\n"
            "RGB. Raises InvalidInput.")
        .def(
            "found",
            [](const StillCoverWatch& self) {
                py::gil_scoped_release release;
                const StillCover found = self.found();
                return found.any() ? std::optional(found) : std::nullopt;
            },
            "StillCover, or None where the frames show none, or are fewer than six.");
}

}  // namespace mimetic::bindings
