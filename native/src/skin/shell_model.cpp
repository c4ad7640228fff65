// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <mutex>
#include <string>

#include "check_mesh.hpp"
#include "cholesky.hpp"
#include "shell_element.hpp"
#include "skin_assembly.hpp"

namespace mimetic {
namespace {

template <typename ElementMatrix>
Columns assemble(const std::vector<SkinTriangle>& elements, TrianglesIn triangles, Eigen::Index num_vertices,
                 const ElementMatrix& element_matrix) {
    Triplets entries;
    entries.reserve(324 * elements.size());
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        const Matrix18 element = element_matrix(elements[f]);
        for (int a = 0; a < 18; ++a) {
            for (int b = 0; b < 18; ++b) {
                entries.emplace_back(6 * face[a / 6] + a % 6, 6 * face[b / 6] + b % 6, element(a, b));
            }
        }
    }
    Columns result(6 * num_vertices, 6 * num_vertices);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

Columns free_unknowns(const std::vector<bool>& held) {
    Triplets entries;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (!held[i]) {
            entries.emplace_back(static_cast<int>(i), static_cast<int>(entries.size()), 1.0);
        }
    }
    Columns basis(held.size(), entries.size());
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
}

}  // namespace

void ShellMaterial::check() const {
    check_range("young", young, 1e-3, 1e12);
    check_range("poisson", poisson, 0, 0.999);
    check_range("thickness", thickness, 1e-6, 1e3);
    check_range("density", density, 0, 1e6);
}

struct ShellModel::Parts {
    Columns stiffness;
    Columns lumped;
    Columns consistent;
    Columns basis;  // 6N x unknowns
    Cholesky factor;
    std::mutex solving;  // as SkinModel::Parts has it

    /// The part of a matrix that acts on what is not held.
    Columns free(const Columns& matrix) const { return basis.transpose() * matrix * basis; }
};

ShellModel::ShellModel(PointsIn vertices, TrianglesIn triangles, const ShellMaterial& material,
                       const std::vector<bool>& held)
    : parts_(std::make_unique<Parts>()) {
    check_mesh(vertices, triangles);
    material.check();
    if (static_cast<Eigen::Index>(held.size()) != 6 * vertices.rows()) {
        throw InvalidInput("held has " + std::to_string(held.size()) + " flags, needed are six for each of " +
                           std::to_string(vertices.rows()) + " vertices");
    }
    parts_->basis = free_unknowns(held);
    if (parts_->basis.cols() == 0) {
        throw InvalidInput("every unknown of the shell is held");
    }
    const std::vector<SkinTriangle> elements = make_skin_triangles(vertices, triangles);
    const auto assembled = [&](const auto& element_matrix) {
        return assemble(elements, triangles, vertices.rows(), element_matrix);
    };
    parts_->stiffness = assembled([&](const SkinTriangle& t) { return shell_stiffness(t, material); });
    parts_->lumped =
        assembled([&](const SkinTriangle& t) { return shell_mass(t, material, MassKind::lumped); });
    parts_->consistent =
        assembled([&](const SkinTriangle& t) { return shell_mass(t, material, MassKind::consistent); });
    parts_->factor.compute(parts_->free(parts_->stiffness));
}

ShellModel::~ShellModel() = default;
ShellModel::ShellModel(ShellModel&&) noexcept = default;
ShellModel& ShellModel::operator=(ShellModel&&) noexcept = default;

const Eigen::SparseMatrix<double>& ShellModel::stiffness() const { return parts_->stiffness; }

const Eigen::SparseMatrix<double>& ShellModel::mass(MassKind kind) const {
    return kind == MassKind::lumped ? parts_->lumped : parts_->consistent;
}

Eigen::MatrixXd ShellModel::solve(const Eigen::Ref<const Eigen::MatrixXd>& forces) const {
    if (forces.rows() != parts_->stiffness.rows()) {
        throw InvalidInput("forces have " + std::to_string(forces.rows()) + " rows, needed are " +
                           std::to_string(parts_->stiffness.rows()));
    }
    if (parts_->factor.info() != Eigen::Success) {
        throw InvalidInput("the shell can move freely: hold more of its unknowns");
    }
    const Eigen::MatrixXd loads = parts_->basis.transpose() * forces;
    const std::lock_guard lock(parts_->solving);
    const Eigen::MatrixXd unknowns = parts_->factor.solve(loads);
    return parts_->basis * unknowns;
}

Eigen::VectorXd ShellModel::frequencies(int count, MassKind kind) const {
    return vibration_modes(parts_->free(parts_->stiffness), parts_->free(mass(kind)), count).frequencies;
}

}  // namespace mimetic
