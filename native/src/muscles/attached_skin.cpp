// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mimetic/muscles/attach.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kNeckBehind = 0.06;    // m; the neck is held so far behind the angle of the jaw
constexpr double kNeckEdge = 0.012;     // m; its lower edge is held
constexpr double kSocketDepth = 0.008;  // m; the lining of the eye sockets is held deeper than this

Flags free_vertices(const SkinMesh& mesh) {
    const TemplateSkin& shared = mesh.shared();
    const Eigen::Index count = mesh.head().num_skin_vertices;
    const double size = mesh.size();
    const auto skin = mesh.neutral().topRows(count);
    const double behind = mesh.landmark_place("gonion.L")[2] - kNeckBehind * size;
    const Flags neck = shared.in_region("neck") && skin.col(2).array() < behind;
    const Flags edge = skin.col(1).array() < skin.col(1).minCoeff() + kNeckEdge * size;
    const Points margin = mesh.places(shared.vertices_between("skin", "eye_socket"));
    const Eigen::VectorXd depth = mesh.whole_surface().distances(margin, kSocketDepth * size);
    const Flags deep = shared.in_region("eye_socket") && !depth.head(count).array().isFinite();
    return !(shared.in_region("ear") || shared.in_region("scalp") || neck || edge || deep);
}

SkinMaterials skin_materials(const SkinMesh& mesh, const MaterialTable& table, VectorIn stiffness) {
    if (stiffness.size() != mesh.vertices().rows()) {
        throw InvalidInput("stiffness has " + std::to_string(stiffness.size()) + " factors for " +
                           std::to_string(mesh.vertices().rows()) + " vertices");
    }
    const Eigen::Index count = mesh.head().num_skin_vertices;
    Eigen::Matrix<double, Eigen::Dynamic, 6> values(count, 6);
    for (int k = 0; k < 6; ++k) {
        values.col(k).setConstant(table.base[k]);
    }
    for (const auto& [region, factors] : table.regions) {
        const Flags inside = mesh.shared().in_region(region);
        for (int k = 0; k < 6; ++k) {
            values.col(k) = inside.select(values.col(k).array() * factors[k], values.col(k).array());
        }
    }
    // Skin and fat are as thick as the face is long: a pull then spreads in proportion too.
    values.col(2).array() *= mesh.local_scale().array();
    values.col(4).array() /= mesh.local_scale().array();
    values.col(5).array() /= mesh.local_scale().array();
    Eigen::Matrix<double, Eigen::Dynamic, 6> refined = mesh.stencils() * values;
    const double reach = table.lid_reach * mesh.size();
    const Points margin = mesh.places(mesh.shared().vertices_between("skin", "eye_socket"));
    const Eigen::VectorXd distance = mesh.whole_surface().distances(margin, 2 * reach);
    for (Eigen::Index v = 0; v < refined.rows(); ++v) {
        const double nearness = std::clamp(2 - distance[v] / reach, 0.0, 1.0);
        const double factor = std::pow(table.lid_attachment, nearness) * stiffness[v];
        refined(v, 4) *= factor;
        refined(v, 5) *= factor;
    }
    return {refined.col(0), refined.col(1), refined.col(2), refined.col(3), refined.col(4), refined.col(5)};
}

}  // namespace

AttachedSkin::AttachedSkin(PointsIn vertices, TrianglesIn triangles, SkinMaterials materials,
                           const SparseRows& stencils, Flags free)
    : vertices_(vertices),
      triangles_(triangles),
      materials_(std::move(materials)),
      free_(std::move(free)),
      basis_(keep_columns(stencils, free_)) {
    if (stencils.rows() != vertices.rows()) {
        throw InvalidInput("stencils have " + std::to_string(stencils.rows()) + " rows for " +
                           std::to_string(vertices.rows()) + " vertices");
    }
}

AttachedSkin::AttachedSkin(const SkinMesh& mesh, const MaterialTable& table, VectorIn stiffness)
    : AttachedSkin(mesh.vertices(), mesh.triangles(), skin_materials(mesh, table, stiffness), mesh.stencils(),
                   free_vertices(mesh)) {}

const SkinModel& AttachedSkin::model() const {
    return model_.get([&] { return SkinModel(vertices_, triangles_, materials_, basis_); });
}

MatrixRows AttachedSkin::respond(MatrixIn forces) const {
    return respond_to_loads(model().loads(forces.transpose()));
}

MatrixRows AttachedSkin::respond_to_loads(const Eigen::Ref<const Eigen::MatrixXd>& loads) const {
    return on_control_vertices(model().solve_loads(loads));
}

MatrixRows AttachedSkin::on_control_vertices(const Eigen::Ref<const Eigen::MatrixXd>& unknowns) const {
    MatrixRows response = MatrixRows::Zero(unknowns.cols(), 3 * free_.size());
    Eigen::Index unknown = 0;
    for (Eigen::Index v = 0; v < free_.size(); ++v) {
        if (free_[v]) {
            response.middleCols<3>(3 * v) = unknowns.middleRows<3>(3 * unknown++).transpose();
        }
    }
    return response;
}

MatrixRows AttachedSkin::foundation_forces(MatrixIn displacements) const {
    MatrixRows forces(displacements.rows(), displacements.cols());
    for (Eigen::Index row = 0; row < forces.rows(); ++row) {
        const Eigen::Map<const Points> moved(displacements.row(row).data(), displacements.cols() / 3, 3);
        Eigen::Map<Points>(forces.row(row).data(), moved.rows(), 3) = model().foundation_forces(moved);
    }
    return forces;
}

SparseRows keep_columns(const SparseRows& matrix, const Flags& kept) {
    if (kept.size() != matrix.cols()) {
        throw InvalidInput("kept has " + std::to_string(kept.size()) + " flags for " +
                           std::to_string(matrix.cols()) + " columns");
    }
    std::vector<int> number(kept.size());
    int count = 0;
    for (Eigen::Index column = 0; column < kept.size(); ++column) {
        number[column] = kept[column] ? count++ : -1;
    }
    SparseRows result(matrix.rows(), count);
    result.reserve(matrix.nonZeros());
    for (int row = 0; row < matrix.outerSize(); ++row) {
        result.startVec(row);
        for (SparseRows::InnerIterator it(matrix, row); it; ++it) {
            if (number[it.col()] >= 0) {
                result.insertBack(row, number[it.col()]) = it.value();
            }
        }
    }
    result.finalize();
    return result;
}

SparseRows keep_rows(const SparseRows& matrix, const std::vector<int>& rows) {
    SparseRows result(static_cast<Eigen::Index>(rows.size()), matrix.cols());
    for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
        if (rows[row] < 0 || rows[row] >= matrix.rows()) {
            throw InvalidInput("row " + std::to_string(rows[row]) + " lies outside the matrix's " +
                               std::to_string(matrix.rows()));
        }
        result.startVec(row);
        for (SparseRows::InnerIterator it(matrix, rows[row]); it; ++it) {
            result.insertBack(row, static_cast<int>(it.col())) = it.value();
        }
    }
    result.finalize();
    return result;
}

}  // namespace mimetic
