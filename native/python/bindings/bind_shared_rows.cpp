// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "compressed_rows.hpp"

namespace mimetic::bindings {

namespace py = pybind11;
using namespace pybind11::literals;

namespace {

/// Throws InvalidInput unless they are rows of a matrix with that many columns.
CompressedRows make_rows(const Eigen::VectorXi& indptr, const Eigen::VectorXi& indices,
                         const Eigen::VectorXd& weights, int num_columns) {
    bool fits = indptr.size() > 0 && indptr[0] == 0 && indptr[indptr.size() - 1] == indices.size() &&
                indices.size() == weights.size() && num_columns > 0 &&
                (indices.size() == 0 || (indices.minCoeff() >= 0 && indices.maxCoeff() < num_columns));
    for (Eigen::Index i = 1; i < indptr.size(); ++i) {
        fits = fits && indptr[i] >= indptr[i - 1];
    }
    if (!fits) {
        throw InvalidInput("got no matrix of compressed rows with " + std::to_string(num_columns) +
                           " columns");
    }
    return {Eigen::Map<const SparseRows>(indptr.size() - 1, num_columns, indices.size(), indptr.data(),
                                         indices.data(), weights.data())};
}

template <typename Number>
py::array_t<Number> copied(const Number* data, Eigen::Index size) {
    return py::array_t<Number>(static_cast<py::ssize_t>(size), data);
}

}  // namespace

void bind_shared_rows(py::module_& m) {
    py::class_<CompressedRows>(m, "CompressedRows", "A sparse matrix, N x C, row by row.")
        .def(py::init(&make_rows), "indptr"_a, "indices"_a, "weights"_a, "num_columns"_a,
             "Row i has the columns indices[indptr[i] : indptr[i + 1]] with those weights.\n\n"
             "indptr: (N + 1,); indices, weights: alike. Raises InvalidInput.")
        .def("__len__", [](const CompressedRows& rows) { return rows.matrix.rows(); })
        .def_property_readonly("num_columns", [](const CompressedRows& rows) { return rows.matrix.cols(); })
        .def_property_readonly(
            "indptr",
            [](const CompressedRows& rows) {
                return copied(rows.matrix.outerIndexPtr(), rows.matrix.outerSize() + 1);
            },
            "(N + 1,) int32")
        .def_property_readonly(
            "indices",
            [](const CompressedRows& rows) {
                return copied(rows.matrix.innerIndexPtr(), rows.matrix.nonZeros());
            },
            "int32")
        .def_property_readonly(
            "weights",
            [](const CompressedRows& rows) { return copied(rows.matrix.valuePtr(), rows.matrix.nonZeros()); },
            "float64")
        .def(
            "multiply",
            [](const CompressedRows& rows, MatrixIn values) -> MatrixRows {
                if (values.rows() != rows.matrix.cols()) {
                    throw InvalidInput("got " + std::to_string(values.rows()) + " rows of values for " +
                                       std::to_string(rows.matrix.cols()) + " columns");
                }
                return rows.matrix * values;
            },
            "values"_a, py::call_guard<py::gil_scoped_release>(), "(N, K) of (C, K) float64.");
}

}  // namespace mimetic::bindings
