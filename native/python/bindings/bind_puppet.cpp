// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/puppet/front_view.hpp>
#include <mimetic/puppet/match.hpp>
#include <mimetic/puppet/texels.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

GrayPicture picture_of(const ImageArray& pixels, const char* name) {
    if (pixels.ndim() != 2 || pixels.shape(0) > 16384 || pixels.shape(1) > 16384) {
        throw InvalidInput(std::string(name) + " must have the shape (height, width) and be uint8");
    }
    const auto rows = static_cast<int>(pixels.shape(0)), cols = static_cast<int>(pixels.shape(1));
    return {rows, cols, {pixels.data(), pixels.data() + pixels.size()}};
}

ImageArray array_of_picture(const GrayPicture& picture) {
    ImageArray pixels({picture.rows, picture.cols});
    std::copy(picture.pixels.begin(), picture.pixels.end(), pixels.mutable_data());
    return pixels;
}

void bind_options(py::module_& m) {
    py::class_<MatchOptions>(m, "MatchOptions", "How templates are searched for.")
        .def(py::init<>())
        .def_readwrite("search_radius", &MatchOptions::search_radius, "pixels about the last place, 1 to 64")
        .def_readwrite("scales", &MatchOptions::scales, "sizes that are tried, 1 is the template's, .5 to 2")
        .def_readwrite("rotations", &MatchOptions::rotations, "rad that are tried, clockwise")
        .def_readwrite("most_pixels", &MatchOptions::most_pixels,
                       "larger templates are matched at half their size, or less")
        .def_readwrite("least_score", &MatchOptions::least_score, "below it a group is lost")
        .def_readwrite("follow", &MatchOptions::follow,
                       "windows follow their group, and a lost one is searched for everywhere");
    py::class_<FrontViewOptions>(m, "FrontViewOptions", "What a FrontView shows; metres, head frame.")
        .def(py::init<>())
        .def_readwrite("pixel", &FrontViewOptions::pixel, "of the picture, on the face")
        .def_readwrite("left", &FrontViewOptions::left)
        .def_readwrite("right", &FrontViewOptions::right)
        .def_readwrite("bottom", &FrontViewOptions::bottom)
        .def_readwrite("top", &FrontViewOptions::top);
}

py::tuple match_arrays(TemplateMatcher& matcher, const ImageArray& image) {
    const GrayView view = view_image<1>(image, "the picture");
    std::vector<TemplateMatch> matches;
    {
        const py::gil_scoped_release unlocked;
        matches = matcher.match(view);
    }
    Eigen::VectorXd scores(static_cast<Eigen::Index>(matches.size()));
    Points2 places(scores.size(), 2);
    MatrixRows sizes(scores.size(), 2);
    for (Eigen::Index i = 0; i < scores.size(); ++i) {
        const TemplateMatch& match = matches[static_cast<std::size_t>(i)];
        scores[i] = match.score;
        places.row(i) = match.place;
        sizes.row(i) << match.scale, match.rotation;
    }
    return py::make_tuple(scores, places, sizes, !matches.empty() && matches.front().found_again);
}

}  // namespace

void bind_puppet(py::module_& m) {
    bind_options(m);
    py::class_<TemplateMatcher>(m, "TemplateMatcher",
                                "Peaks of the normalised correlation of templates with pictures, one after "
                                "the other.")
        .def(py::init([](const std::vector<ImageArray>& pictures, const Points2& places,
                         const std::vector<int>& groups, const MatchOptions& options) {
                 if (static_cast<std::size_t>(places.rows()) != pictures.size() ||
                     groups.size() != pictures.size()) {
                     throw InvalidInput("each template needs a picture, a place and a group");
                 }
                 std::vector<LookTemplate> looks;
                 for (std::size_t i = 0; i < pictures.size(); ++i) {
                     looks.push_back({picture_of(pictures[i], "a template"),
                                      places.row(static_cast<Eigen::Index>(i)).transpose(), groups[i]});
                 }
                 return TemplateMatcher(looks, options);
             }),
             "pictures"_a, "places"_a, "groups"_a, "options"_a = MatchOptions{},
             "pictures: of (h, w) uint8, 8 to 512 a side; places: (n, 2) of their centres, pixels;\n"
             "groups: n whole numbers, equal for templates of one part. Raises InvalidInput.")
        .def("match", &match_arrays, py::arg("picture").noconvert(),
             "Of a picture (H, W) uint8: scores (n,), places (n, 2) in pixels, (n, 2) of scale and rotation\n"
             "(rad), and whether all were found by a search of the whole picture.");
    py::class_<FrontView>(m, "FrontView", "A face as from straight in front, however the head is turned.")
        .def(py::init<const Camera&, PointsIn, QuadsIn, const FrontViewOptions&>(), "camera"_a, "vertices"_a,
             "faces"_a, "options"_a = FrontViewOptions{},
             "vertices: (V, 3) of the neutral face, metres, head frame; faces: (F, 4) of visible skin.\n"
             "Raises InvalidInput.")
        .def(
            "picture",
            [](const FrontView& face, const ImageArray& image, const Eigen::Matrix4d& camera_from_head) {
                const ColorView view = view_image<3>(image, "the frame");
                GrayPicture picture;
                {
                    const py::gil_scoped_release unlocked;
                    picture = face.picture(view, to_isometry(camera_from_head));
                }
                return array_of_picture(picture);
            },
            py::arg("image").noconvert(), "camera_from_head"_a,
            "(rows, cols) uint8 of a frame (H, W, 3) with the head at a pose (4, 4).")
        .def("pixel_of", &FrontView::pixel_of, "x"_a, "y"_a,
             "Pixel of the picture that shows x, y of the head frame, metres.");
    m.def(
        "scaled_gray",
        [](const ImageArray& image, double scale) {
            return array_of_picture(scaled_gray(view_image<3>(image, "the frame"), scale));
        },
        py::arg("image").noconvert(), "scale"_a,
        "A grey picture of a frame (H, W, 3), `scale` times as large; .02 to 8. Raises InvalidInput.");
    m.def(
        "texels_of",
        [](const ImageArray& image, int most_cols) {
            const ColorView view = view_image<3>(image, "the picture");
            Texels texels;
            {
                const py::gil_scoped_release unlocked;
                texels = texels_of(view, most_cols);
            }
            py::array_t<float> array({texels.rows, texels.cols, 4});
            std::copy(texels.values.begin(), texels.values.end(), array.mutable_data());
            return array;
        },
        py::arg("image").noconvert(), "most_cols"_a,
        "A picture (H, W, 3) as graphics cards take it: (h, w, 4) float32, rows from the bottom up, red, "
        "green,\nblue and opacity from 0 to 1, w at most most_cols (16 to 4096). Raises InvalidInput.");
    m.def(
        "correlation_map",
        [](const ImageArray& image, const ImageArray& picture) {
            const GrayPicture part = picture_of(picture, "the template");
            return correlation_map(view_image<1>(image, "the picture"), part.view());
        },
        py::arg("image").noconvert(), py::arg("template").noconvert(),
        "Normalised correlation of a template (h, w) with every window of a picture (H, W).");
}

}  // namespace mimetic::bindings
