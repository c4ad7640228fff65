// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "check_mesh.hpp"
#include "cholesky.hpp"
#include "skin_assembly.hpp"

namespace mimetic {
void SkinMaterials::check(Eigen::Index num_vertices) const {
    const auto check_range = [&](const Eigen::VectorXd& values, const char* name, double low, double high) {
        if (values.size() != num_vertices) {
            throw InvalidInput(std::string(name) + " has " + std::to_string(values.size()) + " values for " +
                               std::to_string(num_vertices) + " vertices");
        }
        for (Eigen::Index v = 0; v < values.size(); ++v) {
            check_range_at(name, v, values[v], low, high);
        }
    };
    check_range(young, "young", 1e-3, 1e12);
    check_range(poisson, "poisson", 0, 0.999);
    check_range(thickness, "thickness", 1e-6, 1e3);
    check_range(pre_stress, "pre_stress", 0, 1e12);
    check_range(tangential, "tangential", 0, 1e15);
    check_range(normal, "normal", 0, 1e15);
}

struct SkinModel::Parts : SkinMatrices {
    BlockCholesky factor;
    std::mutex solving;  // CHOLMOD works in memory of the factor: threads may ask at once, and wait
};

SkinModel::SkinModel(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                     const SparseRows& basis)
    : parts_(std::make_unique<Parts>()) {
    const std::vector<bool> on_boundary = check_mesh(vertices, triangles);
    materials.check(vertices.rows());
    if (basis.rows() != vertices.rows() || basis.cols() == 0) {
        throw InvalidInput("the basis is " + std::to_string(basis.rows()) + " x " +
                           std::to_string(basis.cols()) + ", needed is a row for each of " +
                           std::to_string(vertices.rows()) + " vertices");
    }
    static_cast<SkinMatrices&>(*parts_) = assemble_skin(vertices, triangles, materials, basis, on_boundary);
    parts_->factor.compute_blocks(parts_->stiffness);
}

SkinModel::~SkinModel() = default;
SkinModel::SkinModel(SkinModel&&) noexcept = default;
SkinModel& SkinModel::operator=(SkinModel&&) noexcept = default;

int SkinModel::num_vertices() const { return static_cast<int>(parts_->foundation.size()); }
int SkinModel::num_unknowns() const { return static_cast<int>(parts_->basis.cols() / 3); }
const Eigen::SparseMatrix<double>& SkinModel::stiffness() const { return parts_->stiffness; }
const Eigen::SparseMatrix<double>& SkinModel::basis() const { return parts_->basis; }

Points SkinModel::foundation_forces(PointsIn displacements) const {
    if (displacements.rows() != num_vertices()) {
        throw InvalidInput("got " + std::to_string(displacements.rows()) + " displacements for " +
                           std::to_string(num_vertices()) + " vertices");
    }
    Points forces(displacements.rows(), 3);
    for (Eigen::Index v = 0; v < forces.rows(); ++v) {
        forces.row(v) = displacements.row(v) * parts_->foundation[v];
    }
    return forces;
}

Eigen::MatrixXd SkinModel::loads(const Eigen::Ref<const Eigen::MatrixXd>& forces) const {
    if (forces.rows() != parts_->basis.rows()) {
        throw InvalidInput("forces have " + std::to_string(forces.rows()) +
                           " rows, needed are three for each of " + std::to_string(num_vertices()) +
                           " vertices");
    }
    return parts_->basis.transpose() * forces;
}

Eigen::MatrixXd SkinModel::solve(const Eigen::Ref<const Eigen::MatrixXd>& forces) const {
    return solve_loads(loads(forces));
}

Eigen::MatrixXd SkinModel::solve_loads(const Eigen::Ref<const Eigen::MatrixXd>& loads) const {
    if (loads.rows() != parts_->basis.cols()) {
        throw InvalidInput("loads have " + std::to_string(loads.rows()) +
                           " rows, needed are three for each of " + std::to_string(num_unknowns()) +
                           " unknowns");
    }
    if (parts_->factor.info() != Eigen::Success) {
        throw InvalidInput("the skin can move freely: attach it to bone or hold some of its vertices");
    }
    const std::lock_guard lock(parts_->solving);
    return parts_->factor.solve(loads);
}

}  // namespace mimetic
