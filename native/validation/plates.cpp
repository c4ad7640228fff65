// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "benchmark.hpp"
#include "grid.hpp"

namespace mimetic::validation {
namespace {

constexpr double kYoung = 1e6;
constexpr double kPoisson = 0.3;
constexpr double kThickness = 0.01;
constexpr double kPlate = kYoung * kThickness * kThickness * kThickness / 12 / (1 - kPoisson * kPoisson);

enum class Edge { supported, clamped };

Grid make_square(int n, bool is_even) {
    Grid grid = make_grid(n, n, [](double s, double t) -> Eigen::Vector3d { return {s, t, 0}; });
    if (!is_even) {
        jitter(grid, 0.2);
        grid.vertices.row(grid.at(n / 2, n / 2)) << 0.5, 0.5, 0;  // where the deflection is read
    }
    return grid;
}

/// Unit pressure on a unit square; the middle's deflection times the plate's stiffness.
double shell_plate(int n, Edge edge) {
    const Grid grid = make_square(n, true);
    HeldUnknowns held(grid.num_vertices());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        held.hold(v, {0, 1, 5});
        const int column = v % (n + 1);
        const int row = v / (n + 1);
        if (grid.on_edge(v)) {
            held.hold(v, {2});
            if (edge == Edge::clamped || column == 0 || column == n) {
                held.hold(v, {3});  // no slope along the edge
            }
            if (edge == Edge::clamped || row == 0 || row == n) {
                held.hold(v, {4});
            }
        }
    }
    const ShellModel shell(grid.vertices, grid.triangles, {kYoung, kPoisson, kThickness, 1}, held.flags());
    const Eigen::VectorXd areas = vertex_areas(grid.vertices, grid.triangles);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(6 * grid.num_vertices());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        force[6 * v + 2] = areas[v];
    }
    return shell.solve(force)(6 * grid.at(n / 2, n / 2) + 2, 0) * kPlate;
}

double skin_supported(int n, bool is_even) {
    const Grid grid = make_square(n, is_even);
    std::vector<bool> held(grid.num_vertices());
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    const Eigen::VectorXd areas = vertex_areas(grid.vertices, grid.triangles);
    for (int v = 0; v < grid.num_vertices(); ++v) {
        held[v] = grid.on_edge(v);
        force[3 * v + 2] = areas[v];
    }
    const SkinModel skin(grid.vertices, grid.triangles,
                         even_skin(grid.num_vertices(), kYoung, kPoisson, kThickness), free_basis(held));
    return skin.solve(force)(3 * free_columns(held)[grid.at(n / 2, n / 2)] + 2, 0) * kPlate;
}

/// The skin has no slopes to hold. Its clamp is a ring outside that mirrors the ring inside, the edge's
/// vertices carrying the half of their cells that lies within the plate.
double skin_clamped(int n) {
    const double h = 1.0 / n;
    const Grid grid = make_grid(n + 2, n + 2, [&](double s, double t) -> Eigen::Vector3d {
        return {s * (1 + 2 * h) - h, t * (1 + 2 * h) - h, 0};
    });
    SkinMaterials materials = even_skin(grid.num_vertices(), kYoung, kPoisson, kThickness);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    const auto inner = [&](int column, int row) { return (row - 2) * (n - 1) + column - 2; };
    for (int row = 0; row <= n + 2; ++row) {
        for (int column = 0; column <= n + 2; ++column) {
            const int v = grid.at(column, row);
            const auto mirror = [&](int i) { return i == 0 ? 2 : i == n + 2 ? n : i; };
            const int c = mirror(column);
            const int r = mirror(row);
            if (c > 1 && c < n + 1 && r > 1 && r < n + 1) {
                entries.emplace_back(v, inner(c, r), 1.0);
                force[3 * v + 2] = c == column && r == row ? h * h : 0;
            } else if (column > 0 && column < n + 2 && row > 0 && row < n + 2) {
                materials.young[v] /= 2;
            }
        }
    }
    SparseRows basis(grid.num_vertices(), (n - 1) * (n - 1));
    basis.setFromTriplets(entries.begin(), entries.end());
    const SkinModel skin(grid.vertices, grid.triangles, materials, basis);
    return skin.solve(force)(3 * inner(n / 2 + 1, n / 2 + 1) + 2, 0) * kPlate;
}

/// Bending tones of a strip; n elements along it, two across.
double cantilever(int n, int tone) {
    const Grid grid =
        make_grid(n, 2, [](double s, double t) -> Eigen::Vector3d { return {0.1 * s, 0.01 * t, 0}; });
    HeldUnknowns held(grid.num_vertices());
    for (int v = 0; v < grid.num_vertices(); ++v) {
        held.hold(v, {0, 1, 5});  // bending out of the plane only
    }
    for (int row = 0; row <= 2; ++row) {
        held.hold(grid.at(0, row), {2, 3, 4});
    }
    const ShellModel shell(grid.vertices, grid.triangles, {1e6, 0, 1e-3, 1000}, held.flags());
    return shell.frequencies(3, MassKind::consistent)[tone];
}

}  // namespace

std::vector<Benchmark> plate_benchmarks() {
    const std::vector<int> meshes = {8, 16, 32, 64};
    const std::vector<int> strips = {5, 10, 20, 40};
    const char* middle = "middle, q L^4 / D";
    const char* timoshenko = "Timoshenko and Woinowsky-Krieger";
    const char* beam = "Euler-Bernoulli beam";
    const double tone = std::sqrt(1e6 * 1e-6 / 12 / 1000) / 0.01;  // sqrt(E t^2 / (12 rho)) / L^2
    return {
        {"plate_supported_skin", "Square plate, simply supported", Element::skin, middle, 0.00406235,
         timoshenko, meshes, 32, 0.03, [](int n) { return skin_supported(n, true); }},
        {"plate_irregular_skin", "The same on an irregular mesh", Element::skin, middle, 0.00406235,
         timoshenko, meshes, 32, 0.03, [](int n) { return skin_supported(n, false); }},
        {"plate_supported", "Square plate, simply supported", Element::plate, middle, 0.00406235, timoshenko,
         meshes, 32, 0.03, [](int n) { return shell_plate(n, Edge::supported); }},
        {"plate_clamped_skin", "Square plate, clamped", Element::skin, middle, 0.00126532, timoshenko, meshes,
         32, 0.03, skin_clamped},
        {"plate_clamped", "Square plate, clamped", Element::plate, middle, 0.00126532, timoshenko, meshes, 32,
         0.03, [](int n) { return shell_plate(n, Edge::clamped); }},
        {"cantilever_1", "Cantilever strip, first tone", Element::plate, "Hz", 0.559594 * tone, beam, strips,
         20, 0.03, [](int n) { return cantilever(n, 0); }},
        {"cantilever_2", "Cantilever strip, second tone", Element::plate, "Hz", 3.506907 * tone, beam, strips,
         20, 0.03, [](int n) { return cantilever(n, 1); }},
        {"cantilever_3", "Cantilever strip, third tone", Element::plate, "Hz", 9.819400 * tone, beam, strips,
         20, 0.03, [](int n) { return cantilever(n, 2); }},
    };
}

}  // namespace mimetic::validation
