// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Geometry>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic::bindings {

using ImageArray = pybind11::array_t<std::uint8_t, pybind11::array::c_style>;

/// A view on a numpy image, (H, W) or (H, W, Channels) uint8, C order; the array must outlive the view.
template <int Channels>
ImageView<Channels> view_image(const ImageArray& image, const char* name) {
    const bool fits = Channels == 1 ? image.ndim() == 2 : image.ndim() == 3 && image.shape(2) == Channels;
    if (!fits) {
        throw InvalidInput(std::string(name) + " must have the shape (height, width" +
                           (Channels == 1 ? "" : ", " + std::to_string(Channels)) + ") and be uint8");
    }
    check_image_size(static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)), name);
    return {image.data(), static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)),
            static_cast<std::ptrdiff_t>(image.shape(1)) * Channels};
}

using DoubleArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Matrices of a numpy array (N, Height, Width); throws InvalidInput for another shape.
template <int Height, int Width>
std::vector<Eigen::Matrix<double, Height, Width>> matrices_of(const DoubleArray& array, const char* name) {
    if (array.ndim() != 3 || array.shape(1) != Height || array.shape(2) != Width) {
        throw InvalidInput(std::string(name) + " must have the shape (N, " + std::to_string(Height) + ", " +
                           std::to_string(Width) + ")");
    }
    using InC = Eigen::Matrix<double, Height, Width, Eigen::RowMajor>;
    std::vector<Eigen::Matrix<double, Height, Width>> matrices;
    for (pybind11::ssize_t i = 0; i < array.shape(0); ++i) {
        matrices.push_back(Eigen::Map<const InC>(array.data(i, 0, 0)));
    }
    return matrices;
}

/// The inverse of matrices_of.
template <int Height, int Width>
DoubleArray array_of(const std::vector<Eigen::Matrix<double, Height, Width>>& matrices) {
    DoubleArray array({static_cast<pybind11::ssize_t>(matrices.size()), pybind11::ssize_t{Height},
                       pybind11::ssize_t{Width}});
    using InC = Eigen::Matrix<double, Height, Width, Eigen::RowMajor>;
    for (std::size_t i = 0; i < matrices.size(); ++i) {
        Eigen::Map<InC>(array.mutable_data(static_cast<pybind11::ssize_t>(i), 0, 0)) = matrices[i];
    }
    return array;
}

using ModesArray = pybind11::array_t<double, pybind11::array::c_style>;

/// Displacements (..., V, 3) as rows of x, y, z of each vertex in turn; the array must outlive the view.
inline Eigen::Map<const MatrixRows> view_modes(const char* name, const ModesArray& modes,
                                               Eigen::Index num_vertices) {
    const auto ndim = modes.ndim();
    if (ndim < 3 || modes.shape(ndim - 2) != num_vertices || modes.shape(ndim - 1) != 3) {
        throw InvalidInput(std::string(name) + " must have the shape (number of them, " +
                           std::to_string(num_vertices) + ", 3): one displacement a vertex of neutral");
    }
    return {modes.data(), num_vertices > 0 ? modes.size() / (3 * num_vertices) : 0, 3 * num_vertices};
}

inline Eigen::Isometry3d to_isometry(const Eigen::Matrix4d& matrix) {
    Eigen::Isometry3d pose;
    pose.matrix() = matrix;
    return pose;
}

/// Poses of a numpy array (N, 4, 4).
inline std::vector<Eigen::Isometry3d> poses_of(const DoubleArray& array, const char* name) {
    std::vector<Eigen::Isometry3d> poses;
    for (const Eigen::Matrix4d& matrix : matrices_of<4, 4>(array, name)) {
        poses.push_back(to_isometry(matrix));
    }
    return poses;
}

/// The inverse of poses_of.
inline DoubleArray array_of(const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<Eigen::Matrix4d> matrices;
    for (const Eigen::Isometry3d& pose : poses) {
        matrices.push_back(pose.matrix());
    }
    return array_of<4, 4>(matrices);
}

}  // namespace mimetic::bindings
