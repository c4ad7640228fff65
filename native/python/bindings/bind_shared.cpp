// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/covariance.hpp>
#include <mimetic/shared/rotations.hpp>
#include <mimetic/shared/scale.hpp>
#include <mimetic/shared/similarity.hpp>
#include <mimetic/shared/spread.hpp>

#include "arrays.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

void bind_camera(py::module_& m) {
    py::class_<Camera>(m, "Camera", "Pinhole camera: x right, y down, z forward; pixels.")
        .def(py::init([](double fx, double fy, double cx, double cy, int width, int height) {
                 Camera camera{fx, fy, cx, cy, width, height};
                 camera.check();
                 return camera;
             }),
             "fx"_a, "fy"_a, "cx"_a, "cy"_a, "width"_a, "height"_a,
             "Focal lengths and principal point in pixels; raises InvalidInput.")
        .def_readonly("fx", &Camera::fx)
        .def_readonly("fy", &Camera::fy)
        .def_readonly("cx", &Camera::cx)
        .def_readonly("cy", &Camera::cy)
        .def_readonly("width", &Camera::width)
        .def_readonly("height", &Camera::height)
        .def(
            "pixels",
            [](const Camera& camera, const Points& points_in_head, const Eigen::Matrix4d& camera_from_head) {
                const Eigen::Isometry3d pose = to_isometry(camera_from_head);
                Points2 pixels(points_in_head.rows(), 2);
                for (Eigen::Index i = 0; i < pixels.rows(); ++i) {
                    pixels.row(i) = camera.project(pose * Eigen::Vector3d(points_in_head.row(i)));
                }
                return pixels;
            },
            "points_in_head"_a, "camera_from_head"_a,
            "(N, 2) of points (N, 3), metres, of a head at a pose (4, 4), in front of the camera.");
}

void bind_rotations(py::module_& m) {
    m.def(
        "quaternions", [](const DoubleArray& r) { return quaternions(matrices_of<3, 3>(r, "rotations")); },
        "rotations"_a,
        "(N, 4) unit quaternions (w x y z) of (N, 3, 3) rotations, each nearest to the one before.");
    m.def(
        "rotation_vectors",
        [](const DoubleArray& r) { return rotation_vectors(matrices_of<3, 3>(r, "rotations")); },
        "rotations"_a,
        "(N, 3) axes times angles, radians, of (N, 3, 3) rotations, each the one nearest to that before "
        "it:\na rotation on past half a turn gives vectors longer than pi, not a jump.");
    m.def(
        "from_rotation_vectors",
        [](PointsIn vectors) {
            Rotations rotations;
            for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
                rotations.push_back(rotation_from_vector(vectors.row(i).transpose()));
            }
            return array_of<3, 3>(rotations);
        },
        "vectors"_a, "(N, 3, 3) rotations of (N, 3) axes times angles, radians.");
    m.def(
        "angles_from",
        [](const DoubleArray& poses, const Eigen::Matrix4d& reference) {
            return angles_from(poses_of(poses, "poses"), to_isometry(reference));
        },
        "poses"_a, "reference"_a,
        "(N,) radians by which poses (N, 4, 4) are turned from a reference (4, 4).");
    m.def(
        "nearest_rotations",
        [](const DoubleArray& matrices) {
            Rotations rotations = matrices_of<3, 3>(matrices, "matrices");
            for (Eigen::Matrix3d& rotation : rotations) {
                rotation = nearest_rotation(rotation);
            }
            return array_of<3, 3>(rotations);
        },
        "matrices"_a, "(N, 3, 3) rotations nearest to matrices (N, 3, 3), orthonormal to the last digit.");
    m.def(
        "turn_between",
        [](const Eigen::Matrix3d& before, const Eigen::Matrix3d& after) {
            return rotation_vectors({after * before.transpose()}).row(0).norm();
        },
        "before"_a, "after"_a, "Radians between two rotations (3, 3).");
    m.def(
        "euler_angles",
        [](const DoubleArray& r, const std::string& order, const Eigen::Vector3d& first) {
            return euler_angles(matrices_of<3, 3>(r, "rotations"), order, first);
        },
        "rotations"_a, "order"_a, "first"_a = Eigen::Vector3d(Eigen::Vector3d::Zero()),
        "(N, 3) angles about x, y and z, radians, of (N, 3, 3) rotations.\n\norder: such as 'XYZ', the "
        "first letter turns first, as in Blender; first: (3,)\nwhat the first row shall be near to; each "
        "later "
        "row is near to the one before.\nRaises InvalidInput.");
}

void bind_similarity(py::module_& m) {
    py::class_<Similarity>(m, "Similarity", "target = scale * rotation @ source + shift.")
        .def_readonly("scale", &Similarity::scale)
        .def_readonly("rotation", &Similarity::rotation)
        .def_readonly("shift", &Similarity::shift)
        .def_readonly("is_mirror", &Similarity::is_mirror,
                      "whether the points align better with their mirror image")
        .def("apply", &Similarity::apply, "points"_a, "(K, 3)")
        .def(
            "turn",
            [](const Similarity& self, const DoubleArray& displacements) {
                if (displacements.ndim() < 1 || displacements.shape(displacements.ndim() - 1) != 3) {
                    throw InvalidInput("displacements must have the shape (..., 3)");
                }
                DoubleArray turned(std::vector<py::ssize_t>(displacements.shape(),
                                                            displacements.shape() + displacements.ndim()));
                const Eigen::Index count = displacements.size() / 3;
                Eigen::Map<Points>(turned.mutable_data(), count, 3) =
                    self.turn(Eigen::Map<const Points>(displacements.data(), count, 3));
                return turned;
            },
            "displacements"_a, "(..., 3), without the shift")
        .def("inverse", &Similarity::inverse);
    m.def("fit_similarity", &fit_similarity, "source"_a, "target"_a,
          "The Similarity that aligns points (K, 3) with others (K, 3), in least squares.");
}

}  // namespace

void bind_shared(py::module_& m) {
    bind_camera(m);
    bind_rotations(m);
    bind_similarity(m);
    m.def(
        "are_covariances",
        [](const DoubleArray& covariances, double asymmetry) {
            py::array_t<bool> fits(covariances.ndim() > 0 ? covariances.shape(0) : 0);
            bool* out = fits.mutable_data();
            for (const auto& matrix : matrices_of<6, 6>(covariances, "covariances")) {
                *out++ = is_covariance(matrix, asymmetry);
            }
            return fits;
        },
        "covariances"_a, "asymmetry"_a,
        "(N,) which of (N, 6, 6) are covariances but for rounding; asymmetry: between mirrored entries.");
    m.def(
        "are_rigid",
        [](const DoubleArray& poses, double rounding) {
            py::array_t<bool> fits(poses.ndim() > 0 ? poses.shape(0) : 0);
            bool* out = fits.mutable_data();
            for (const Eigen::Matrix4d& pose : matrices_of<4, 4>(poses, "poses")) {
                *out++ = is_rigid(pose, rounding);
            }
            return fits;
        },
        "poses"_a, "rounding"_a,
        "(N,) which of (N, 4, 4) turn and shift without scaling or mirroring; rounding: of R R' - 1.");
    m.attr("PUPIL_DISTANCE") = kPupilDistance;
    m.def("drawn_apart", &drawn_apart, "points"_a, "least"_a,
          "(N, 3): points moved apart in x and z until none are nearer there, metres.\nRaises InvalidInput.");
    m.def("spread_rows", &spread_rows, "rows"_a, "first"_a, "allowed"_a, "count"_a, "least"_a = 0.0,
          py::call_guard<py::gil_scoped_release>(),
          "Rows of a table (N, D) that lie well apart: `first`, then repeatedly the allowed row farthest "
          "from all\nthat are chosen, until there are `count`, or the farthest is nearer than `least`.\n\n"
          "allowed: N booleans. Raises InvalidInput.");
    m.def(
        "nearest_covariances",
        [](const DoubleArray& covariances) {
            std::vector<Eigen::Matrix<double, 6, 6>> matrices = matrices_of<6, 6>(covariances, "covariances");
            for (auto& matrix : matrices) {
                matrix = nearest_covariance(matrix);
            }
            return array_of<6, 6>(matrices);
        },
        "covariances"_a,
        "(N, 6, 6) symmetric and positive definite, nearest to matrices with rounding errors; compared as "
        "correlations.");
}

}  // namespace mimetic::bindings
