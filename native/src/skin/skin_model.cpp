// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/CholmodSupport>
#include <Eigen/Geometry>
#include <mimetic/error.hpp>
#include <mimetic/skin.hpp>
#include <string>
#include <utility>
#include <vector>

#include "check_mesh.hpp"

namespace mimetic {
namespace {

using Columns = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

struct Triangle {
    Eigen::Matrix3d corners;            // a column a corner
    Eigen::Vector3d normal;             // unit
    Eigen::Matrix<double, 2, 3> axes;   // the element's own plane, rows e1, e2
    Eigen::Matrix<double, 2, 3> slope;  // gradients of the three shape functions in that plane, 1/m
    double area = 0;
};

Triangle make_triangle(PointsIn vertices, const Eigen::RowVector3i& face) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
        t.corners.col(k) = vertices.row(face[k]);
    }
    const Eigen::Vector3d ab = t.corners.col(1) - t.corners.col(0);
    const Eigen::Vector3d cross = ab.cross(Eigen::Vector3d(t.corners.col(2) - t.corners.col(0)));
    t.area = cross.norm() / 2;
    t.normal = cross.normalized();
    t.axes.row(0) = ab.normalized();
    t.axes.row(1) = t.normal.cross(Eigen::Vector3d(t.axes.row(0)));
    const Eigen::Matrix<double, 2, 3> p = t.axes * t.corners;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        t.slope.col(i) << p(1, j) - p(1, k), p(0, k) - p(0, j);
    }
    t.slope /= 2 * t.area;
    return t;
}

double mean(const Eigen::VectorXd& values, const Eigen::RowVector3i& face) {
    return (values[face[0]] + values[face[1]] + values[face[2]]) / 3;
}

/// Membrane with its pre-stress: 9 x 9, N/m.
Eigen::Matrix<double, 9, 9> membrane_stiffness(const Triangle& t, const SkinMaterials& m,
                                               const Eigen::RowVector3i& face) {
    const double poisson = mean(m.poisson, face);
    const double thickness = mean(m.thickness, face);
    Eigen::Matrix3d elastic;
    elastic << 1, poisson, 0, poisson, 1, 0, 0, 0, (1 - poisson) / 2;
    elastic *= mean(m.young, face) / (1 - poisson * poisson);
    Eigen::Matrix<double, 3, 9> strain;
    for (int k = 0; k < 3; ++k) {
        Eigen::Matrix<double, 3, 2> plane;
        plane << t.slope(0, k), 0, 0, t.slope(1, k), t.slope(1, k), t.slope(0, k);
        strain.middleCols<3>(3 * k) = plane * t.axes;
    }
    Eigen::Matrix<double, 9, 9> stiffness = t.area * thickness * strain.transpose() * elastic * strain;
    // A stressed membrane resists leaving its plane.
    const Eigen::Matrix3d coupling =
        mean(m.pre_stress, face) * thickness * t.area * t.slope.transpose() * t.slope;
    const Eigen::Matrix3d outwards = t.normal * t.normal.transpose();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            stiffness.block<3, 3>(3 * i, 3 * j) += coupling(i, j) * outwards;
        }
    }
    return stiffness;
}

/// The basis once for each of x, y, z, interleaved.
Columns interleave(const SparseRows& basis) {
    Triplets entries;
    entries.reserve(3 * basis.nonZeros());
    for (int row = 0; row < basis.outerSize(); ++row) {
        for (SparseRows::InnerIterator it(basis, row); it; ++it) {
            for (int axis = 0; axis < 3; ++axis) {
                entries.emplace_back(3 * row + axis, 3 * static_cast<int>(it.col()) + axis, it.value());
            }
        }
    }
    Columns result(3 * basis.rows(), 3 * basis.cols());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

}  // namespace

void SkinMaterials::check(Eigen::Index num_vertices) const {
    const auto check_range = [&](const Eigen::VectorXd& values, const char* name, double low, double high) {
        if (values.size() != num_vertices) {
            throw InvalidInput(std::string(name) + " has " + std::to_string(values.size()) + " values for " +
                               std::to_string(num_vertices) + " vertices");
        }
        for (Eigen::Index v = 0; v < values.size(); ++v) {
            if (!(values[v] >= low && values[v] <= high)) {
                throw InvalidInput(std::string(name) + " at vertex " + std::to_string(v) + " is " +
                                   std::to_string(values[v]) + ", allowed are " + std::to_string(low) +
                                   " to " + std::to_string(high));
            }
        }
    };
    check_range(young, "young", 1e-3, 1e12);
    check_range(poisson, "poisson", 0, 0.999);
    check_range(thickness, "thickness", 1e-6, 1e3);
    check_range(pre_stress, "pre_stress", 0, 1e12);
    check_range(tangential, "tangential", 0, 1e15);
    check_range(normal, "normal", 0, 1e15);
}

struct SkinModel::Parts {
    Columns basis;  // 3N x 3C
    Columns stiffness;
    std::vector<Eigen::Matrix3d> foundation;  // a vertex, N/m
    Eigen::CholmodSupernodalLLT<Columns> factor;

    void assemble(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                  const SparseRows& scalar_basis, const std::vector<bool>& on_boundary);
};

void SkinModel::Parts::assemble(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                                const SparseRows& scalar_basis, const std::vector<bool>& on_boundary) {
    const Eigen::Index num_vertices = vertices.rows();
    Triplets membrane;
    membrane.reserve(81 * triangles.rows() + 9 * num_vertices);
    Triplets laplacian;
    laplacian.reserve(9 * triangles.rows());
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(num_vertices);
    Points normals = Points::Zero(num_vertices, 3);
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        const Triangle t = make_triangle(vertices, face);
        const auto stiffness_e = membrane_stiffness(t, materials, face);
        const Eigen::Matrix3d cotangent = t.area * t.slope.transpose() * t.slope;
        for (int i = 0; i < 3; ++i) {
            areas[face[i]] += t.area / 3;
            normals.row(face[i]) += t.area * t.normal.transpose();
            for (int j = 0; j < 3; ++j) {
                laplacian.emplace_back(face[i], face[j], cotangent(i, j));
                for (int entry = 0; entry < 9; ++entry) {
                    const int a = entry / 3;
                    const int b = entry % 3;
                    membrane.emplace_back(3 * face[i] + a, 3 * face[j] + b,
                                          stiffness_e(3 * i + a, 3 * j + b));
                }
            }
        }
    }
    foundation.resize(num_vertices);
    Eigen::VectorXd flexure(num_vertices);  // plate stiffness over area; a free edge carries no moment
    for (Eigen::Index v = 0; v < num_vertices; ++v) {
        const Eigen::Vector3d n = normals.row(v).normalized();
        foundation[v] = areas[v] * (materials.tangential[v] * Eigen::Matrix3d::Identity() +
                                    (materials.normal[v] - materials.tangential[v]) * n * n.transpose());
        const double plate = materials.young[v] * std::pow(materials.thickness[v], 3) / 12 /
                             (1 - materials.poisson[v] * materials.poisson[v]);
        flexure[v] = on_boundary[v] ? 0 : plate / areas[v];
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                membrane.emplace_back(3 * v + a, 3 * v + b, foundation[v](a, b));
            }
        }
    }
    Columns nodal(3 * num_vertices, 3 * num_vertices);
    nodal.setFromTriplets(membrane.begin(), membrane.end());
    Columns l(num_vertices, num_vertices);
    l.setFromTriplets(laplacian.begin(), laplacian.end());
    const Columns curvature = l * Columns(scalar_basis);
    const SparseRows bending = curvature.transpose() * flexure.asDiagonal() * curvature;
    const Columns force = nodal * basis;
    stiffness = Columns(basis.transpose() * force) + interleave(bending);
}

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
    parts_->basis = interleave(basis);
    parts_->assemble(vertices, triangles, materials, basis, on_boundary);
    cholmod_common& cholmod = parts_->factor.cholmod();
    cholmod.print = 0;     // CHOLMOD writes warnings to the terminal by default
    cholmod.nmethods = 1;  // trying the other orderings costs more than the best of them saves
    cholmod.method[0].ordering = CHOLMOD_AMD;
    parts_->factor.compute(parts_->stiffness);
}

SkinModel::~SkinModel() = default;
SkinModel::SkinModel(SkinModel&&) noexcept = default;
SkinModel& SkinModel::operator=(SkinModel&&) noexcept = default;

int SkinModel::num_vertices() const { return static_cast<int>(parts_->foundation.size()); }
int SkinModel::num_unknowns() const { return static_cast<int>(parts_->basis.cols() / 3); }
const Eigen::SparseMatrix<double>& SkinModel::stiffness() const { return parts_->stiffness; }

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

Eigen::MatrixXd SkinModel::solve(const Eigen::Ref<const Eigen::MatrixXd>& forces) const {
    if (forces.rows() != parts_->basis.rows()) {
        throw InvalidInput("forces have " + std::to_string(forces.rows()) +
                           " rows, needed are three for each of " + std::to_string(num_vertices()) +
                           " vertices");
    }
    if (parts_->factor.info() != Eigen::Success) {
        throw InvalidInput("the skin can move freely: attach it to bone or hold some of its vertices");
    }
    const Eigen::MatrixXd loads = parts_->basis.transpose() * forces;
    return parts_->factor.solve(loads);
}

}  // namespace mimetic
