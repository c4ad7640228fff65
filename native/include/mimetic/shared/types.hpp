// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>

namespace mimetic {

/// Row-major, so that numpy's arrays are read in place.
template <typename Scalar, int Columns>
using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Columns, Eigen::RowMajor>;

using Points = Rows<double, 3>;   ///< one point a row, metres
using Points2 = Rows<double, 2>;  ///< one point a row, pixels; (0, 0) is the centre of the top-left pixel
using Triangles = Rows<int, 3>;   ///< vertex indices, counter-clockwise seen from outside
using Quads = Rows<int, 4>;       ///< vertex indices, counter-clockwise seen from outside
using MatrixRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The corners of the two triangles that a quad is, wherever one is needed that is flat.
inline constexpr std::array<std::array<int, 3>, 2> kQuadHalves{{{0, 1, 2}, {0, 2, 3}}};

using PointsIn = const Eigen::Ref<const Points>&;
using Points2In = const Eigen::Ref<const Points2>&;
using TrianglesIn = const Eigen::Ref<const Triangles>&;
using QuadsIn = const Eigen::Ref<const Quads>&;
using MatrixIn = const Eigen::Ref<const MatrixRows>&;
using VectorIn = const Eigen::Ref<const Eigen::VectorXd>&;

}  // namespace mimetic
