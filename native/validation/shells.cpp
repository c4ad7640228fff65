// SPDX-License-Identifier: GPL-3.0-or-later
// The shell obstacle course (Belytschko et al. 1985; MacNeal and Harder 1985), by symmetry on a part each.
#include <cmath>
#include <numbers>

#include "benchmark.hpp"
#include "grid.hpp"

namespace mimetic::validation {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Holds what a plane of symmetry with this normal axis holds.
void hold_symmetry(HeldUnknowns& held, int vertex, int axis) {
    held.hold(vertex, {axis, 3 + (axis + 1) % 3, 3 + (axis + 2) % 3});
}

/// Part of a cylinder about the x axis, from the middle to a diaphragm, from the crown down to `angle`.
Grid make_cylinder(int n, double radius, double length, double angle) {
    return make_grid(n, n, [=](double s, double t) -> Eigen::Vector3d {
        return {length * s, radius * std::sin(angle * t), radius * std::cos(angle * t)};
    });
}

void hold_cylinder(HeldUnknowns& held, const Grid& grid) {
    for (int i = 0; i <= grid.rows; ++i) {
        hold_symmetry(held, grid.at(0, i), 0);
        hold_symmetry(held, grid.at(i, 0), 1);
        held.hold(grid.at(grid.columns, i), {1, 2});  // a diaphragm keeps the ring in its shape
    }
}

double scordelis_lo(int n) {
    const Grid grid = make_cylinder(n, 25, 25, 40 * kDegree);
    HeldUnknowns held(grid.num_vertices());
    hold_cylinder(held, grid);
    const ShellModel shell(grid.vertices, grid.triangles, {4.32e8, 0, 0.25, 1}, held.flags());
    Eigen::VectorXd force = Eigen::VectorXd::Zero(6 * grid.num_vertices());
    const Eigen::VectorXd areas = vertex_areas(grid.vertices, grid.triangles);
    for (int v = 0; v < grid.num_vertices(); ++v) {
        force[6 * v + 2] = -90 * areas[v];
    }
    return -shell.solve(force)(6 * grid.at(0, n) + 2, 0);
}

double pinched_cylinder(int n) {
    const Grid grid = make_cylinder(n, 300, 300, 90 * kDegree);
    HeldUnknowns held(grid.num_vertices());
    hold_cylinder(held, grid);
    for (int column = 0; column <= n; ++column) {
        hold_symmetry(held, grid.at(column, n), 2);
    }
    const ShellModel shell(grid.vertices, grid.triangles, {3e6, 0.3, 3, 1}, held.flags());
    Eigen::VectorXd force = Eigen::VectorXd::Zero(6 * grid.num_vertices());
    force[6 * grid.at(0, 0) + 2] = -0.25;  // an eighth of the cylinder holds a quarter of the load
    return -shell.solve(force)(6 * grid.at(0, 0) + 2, 0);
}

double pinched_hemisphere(int n) {
    const Grid grid = make_grid(n, n, [](double s, double t) -> Eigen::Vector3d {
        const double azimuth = 90 * kDegree * s;
        const double latitude = 72 * kDegree * t;
        return {10 * std::cos(latitude) * std::cos(azimuth), 10 * std::cos(latitude) * std::sin(azimuth),
                10 * std::sin(latitude)};
    });
    HeldUnknowns held(grid.num_vertices());
    for (int row = 0; row <= n; ++row) {
        hold_symmetry(held, grid.at(0, row), 1);
        hold_symmetry(held, grid.at(n, row), 0);
    }
    held.hold(grid.at(0, 0), {2});
    const ShellModel shell(grid.vertices, grid.triangles, {6.825e7, 0.3, 0.04, 1}, held.flags());
    Eigen::VectorXd force = Eigen::VectorXd::Zero(6 * grid.num_vertices());
    force[6 * grid.at(0, 0)] = 1;
    force[6 * grid.at(n, 0) + 1] = -1;
    return shell.solve(force)(6 * grid.at(0, 0), 0);
}

}  // namespace

std::vector<Benchmark> shell_benchmarks() {
    const std::vector<int> meshes = {8, 16, 32, 64};
    return {
        {"scordelis_lo", "Scordelis-Lo roof", Element::plate, "sag of the free edge's middle", 0.3024,
         "MacNeal and Harder 1985", meshes, 32, 0.03, scordelis_lo},
        {"pinched_cylinder", "Pinched cylinder", Element::plate, "deflection under the load", 1.8248e-5,
         "Belytschko et al. 1985", meshes, 32, 0.03, pinched_cylinder},
        {"pinched_hemisphere", "Pinched hemisphere, 18 degree hole", Element::plate,
         "deflection under the load", 0.0940, "MacNeal and Harder 1985", meshes, 32, 0.03,
         pinched_hemisphere},
    };
}

}  // namespace mimetic::validation
