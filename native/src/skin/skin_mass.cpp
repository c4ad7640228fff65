// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <string>

#include "check_mesh.hpp"
#include "skin_assembly.hpp"

namespace mimetic {

Eigen::SparseMatrix<double> skin_mass(const SkinModel& model, PointsIn vertices, TrianglesIn triangles,
                                      VectorIn surface_density) {
    check_mesh(vertices, triangles);
    if (vertices.rows() != model.num_vertices() || surface_density.size() != model.num_vertices()) {
        throw InvalidInput("got " + std::to_string(vertices.rows()) + " vertices and " +
                           std::to_string(surface_density.size()) + " densities for a model of " +
                           std::to_string(model.num_vertices()) + " vertices");
    }
    for (Eigen::Index v = 0; v < surface_density.size(); ++v) {
        if (!(surface_density[v] > 0 && surface_density[v] < 1e9)) {
            throw InvalidInput("surface_density at vertex " + std::to_string(v) + " is " +
                               std::to_string(surface_density[v]) + ", allowed are above 0 to 1e9");
        }
    }
    Triplets entries;
    entries.reserve(27 * triangles.rows());
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        const double density =
            (surface_density[face[0]] + surface_density[face[1]] + surface_density[face[2]]) / 3;
        const Matrix9 mass = consistent_mass(make_skin_triangle(vertices, face), density);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                for (int axis = 0; axis < 3; ++axis) {
                    entries.emplace_back(3 * face[i] + axis, 3 * face[j] + axis, mass(3 * i, 3 * j));
                }
            }
        }
    }
    Columns nodal(3 * vertices.rows(), 3 * vertices.rows());
    nodal.setFromTriplets(entries.begin(), entries.end());
    return model.basis().transpose() * Columns(nodal * model.basis());
}

}  // namespace mimetic
