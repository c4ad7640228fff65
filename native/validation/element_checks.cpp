// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold exactly on any mesh: patch tests, free rigid motion, balance of energy.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <mimetic/surface/surface.hpp>

#include "benchmark.hpp"
#include "grid.hpp"

namespace mimetic::validation {
namespace {

constexpr double kRounding = 1e-9;

Grid make_patch(int n, double irregularity) {
    Grid grid =
        make_grid(n, n, [](double s, double t) -> Eigen::Vector3d { return {0.24 * s, 0.12 * t, 0}; });
    jitter(grid, irregularity);
    return grid;
}

/// A bent, open sheet without symmetry.
Grid make_sheet(int n) {
    return make_grid(n, n, [](double s, double t) -> Eigen::Vector3d {
        return {0.1 * s, 0.05 * std::sin(2.5 * t + s), 0.05 * std::cos(2.5 * t) + 0.02 * s * s};
    });
}

/// A closed box rounded by subdivision: an open, unattached sheet's corners would be free to flap besides.
Grid make_pebble(int n) {
    Points corners(8, 3);
    for (int i = 0; i < 8; ++i) {
        corners.row(i) << (i & 1 ? 0.06 : -0.06), (i & 2 ? 0.05 : -0.05), (i & 4 ? 0.04 : -0.04);
    }
    Quads quads(6, 4);
    quads << 0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5;
    const SubdividedMesh mesh(quads, 8, n == 4 ? 1 : 2);
    Grid grid{0, 0, mesh.positions(corners), Triangles(2 * mesh.faces().rows(), 3)};
    for (Eigen::Index f = 0; f < mesh.faces().rows(); ++f) {
        const Eigen::RowVector4i q = mesh.faces().row(f);
        grid.triangles.middleRows<2>(2 * f) << q[0], q[1], q[2], q[0], q[2], q[3];
    }
    return grid;
}

double relative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).norm() / b.norm(); }

double membrane_patch(int n) {
    const Grid grid = make_patch(n, 0.2);
    const SkinModel skin(grid.vertices, grid.triangles, even_skin(grid.num_vertices(), 1e6, 0.25, 1e-3),
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    std::vector<bool> prescribed(3 * grid.num_vertices(), false);
    Eigen::VectorXd exact(3 * grid.num_vertices());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        const Eigen::RowVector3d p = grid.vertices.row(v);
        exact.segment<3>(3 * v) << 1e-3 * (p.x() + p.y() / 2), 1e-3 * (p.y() + p.x() / 2), 0;
        prescribed[3 * v] = prescribed[3 * v + 1] = grid.on_edge(v);
        prescribed[3 * v + 2] = true;
    }
    return relative(solve_prescribed(skin.stiffness(), prescribed, exact), exact);
}

double plate_patch(int n) {
    const Grid grid = make_patch(n, 0.2);
    const std::vector<bool> free(6 * grid.num_vertices(), false);
    const ShellModel shell(grid.vertices, grid.triangles, {1e6, 0.25, 1e-3, 1}, free);
    std::vector<bool> prescribed(free.size());
    Eigen::VectorXd exact = Eigen::VectorXd::Zero(free.size());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        const double x = grid.vertices(v, 0);
        const double y = grid.vertices(v, 1);
        exact.segment<3>(6 * v + 2) << 1e-3 * (x * x + x * y + y * y) / 2, 1e-3 * (x / 2 + y),
            -1e-3 * (x + y / 2);
        for (int axis = 0; axis < 6; ++axis) {
            prescribed[6 * v + axis] = grid.on_edge(v) || axis < 2 || axis == 5;
        }
    }
    return relative(solve_prescribed(shell.stiffness(), prescribed, exact), exact);
}

/// The skin's curvature is that of the cotangent Laplacian: exact for a quadratic on even triangles only.
double skin_bending_patch(int n) {
    const Grid grid = make_patch(n, 0);
    const SkinModel skin(grid.vertices, grid.triangles, even_skin(grid.num_vertices(), 1e6, 0.25, 1e-3),
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    std::vector<bool> prescribed(3 * grid.num_vertices(), true);
    Eigen::VectorXd exact = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        const double x = grid.vertices(v, 0);
        const double y = grid.vertices(v, 1);
        exact[3 * v + 2] = 1e-3 * (x * x + x * y + y * y) / 2;
        const int column = v % (n + 1);
        const int row = v / (n + 1);  // two rows at the edge prescribe deflection and slope
        prescribed[3 * v + 2] = std::min({column, row, n - column, n - row}) < 2;
    }
    return relative(solve_prescribed(skin.stiffness(), prescribed, exact), exact);
}

double count_free_motions(const Eigen::MatrixXd& stiffness) {
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
    return static_cast<double>((values.array() < 1e-11 * values[values.size() - 1]).count());
}

double skin_free_motions(int n) {
    const Grid grid = make_pebble(n);
    const SkinModel skin(grid.vertices, grid.triangles, even_skin(grid.num_vertices(), 1e6, 0.3, 0.01),
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    return count_free_motions(skin.stiffness());
}

double shell_free_motions(int n) {
    const Grid grid = make_pebble(n);
    const std::vector<bool> free(6 * grid.num_vertices(), false);
    return count_free_motions(
        ShellModel(grid.vertices, grid.triangles, {1e6, 0.3, 0.01, 1}, free).stiffness());
}

/// Work of the load over twice the energy, less one.
double energy_imbalance(const Eigen::SparseMatrix<double>& stiffness, const Eigen::VectorXd& force,
                        const Eigen::VectorXd& displacement) {
    return std::abs(displacement.dot(stiffness * displacement) / force.dot(displacement) - 1);
}

double skin_energy(int n) {
    const Grid grid = make_sheet(n);
    SkinMaterials materials = even_skin(grid.num_vertices(), 40e3, 0.49, 1.5e-3);
    materials.pre_stress.setConstant(20e3);
    materials.tangential.setConstant(2e5);
    materials.normal.setConstant(1e6);
    const SkinModel skin(grid.vertices, grid.triangles, materials,
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(3 * grid.num_vertices(), -1, 2);
    return energy_imbalance(skin.stiffness(), force, skin.solve(force));
}

double shell_energy(int n) {
    const Grid grid = make_sheet(n);
    HeldUnknowns held(grid.num_vertices());
    for (int i = 0; i <= n; ++i) {
        held.hold(grid.at(0, i), {0, 1, 2, 3, 4, 5});
    }
    const ShellModel shell(grid.vertices, grid.triangles, {1e6, 0.3, 0.01, 1}, held.flags());
    Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(6 * grid.num_vertices(), -1, 2);
    return energy_imbalance(shell.stiffness(), force, shell.solve(force));
}

}  // namespace

std::vector<Benchmark> element_benchmarks() {
    const char* patch = "MacNeal and Harder 1985";
    const char* solution = "relative error of the solution";
    const char* motions = "free motions before attachment";
    const char* energy = "work of the load against twice the energy";
    const std::vector<int> meshes = {4, 8};
    return {
        {"membrane_patch", "Membrane patch test, irregular", Element::skin, solution, 0, patch, meshes, 4,
         kRounding, membrane_patch},
        {"bending_patch_skin", "Bending patch test, even", Element::skin, solution, 0, patch, meshes, 4,
         kRounding, skin_bending_patch},
        {"bending_patch", "Bending patch test, irregular", Element::plate, solution, 0, patch, meshes, 4,
         kRounding, plate_patch},
        {"rigid_motion_skin", "Rigid motion", Element::skin, motions, 6, "exact", meshes, 4, kRounding,
         skin_free_motions},
        {"rigid_motion", "Rigid motion", Element::plate, motions, 6, "exact", meshes, 4, kRounding,
         shell_free_motions},
        {"energy_skin", "Static energy balance", Element::skin, energy, 0, "exact", meshes, 4, kRounding,
         skin_energy},
        {"energy", "Static energy balance", Element::plate, energy, 0, "exact", meshes, 4, kRounding,
         shell_energy},
    };
}

}  // namespace mimetic::validation
