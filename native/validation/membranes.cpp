// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mimetic/skin/skin_dynamics.hpp>

#include "benchmark.hpp"
#include "grid.hpp"

namespace mimetic::validation {
namespace {

/// A tapered panel, clamped at the left, sheared by a unit load at the right: middle of the right edge.
double cook(int n) {
    const Grid grid = make_grid(
        n, n, [](double s, double t) -> Eigen::Vector3d { return {48 * s, 44 * s + t * (44 - 28 * s), 0}; });
    SkinMaterials materials = even_skin(grid.num_vertices(), 1, 1.0 / 3, 1);
    materials.normal.setOnes();  // keeps the panel in its plane, where nothing else loads it
    std::vector<bool> held(grid.num_vertices(), false);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    for (int row = 0; row <= n; ++row) {
        held[grid.at(0, row)] = true;
        force[3 * grid.at(n, row) + 1] = (row == 0 || row == n ? 0.5 : 1.0) / n;
    }
    const SkinModel skin(grid.vertices, grid.triangles, materials, free_basis(held));
    return skin.solve(force)(3 * free_columns(held)[grid.at(n, n / 2)] + 1, 0);
}

constexpr double kSide = 0.1;
constexpr double kTension = 30;    // N/m
constexpr double kDensity = 1.65;  // kg/m^2
constexpr double kThickness = 1.5e-3;

/// A square of tense skin without elasticity of its own, held along its edge.
struct Drum {
    explicit Drum(int n)
        : grid(make_grid(n, n,
                         [](double s, double t) -> Eigen::Vector3d { return {kSide * s, kSide * t, 0}; })),
          held(grid.num_vertices()) {
        for (int v = 0; v < grid.num_vertices(); ++v) {
            held[v] = grid.on_edge(v);
        }
    }
    SkinModel skin() const {
        SkinMaterials materials = even_skin(grid.num_vertices(), 1, 0, kThickness);
        materials.pre_stress.setConstant(kTension / kThickness);
        materials.tangential.setConstant(1e9);  // motion out of the plane only
        return {grid.vertices, grid.triangles, materials, free_basis(held)};
    }
    int middle() const { return grid.at(grid.columns / 2, grid.rows / 2); }

    Grid grid;
    std::vector<bool> held;
};

double drum_sag(int n) {
    const Drum drum(n);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * drum.grid.num_vertices());
    const Eigen::VectorXd areas = vertex_areas(drum.grid.vertices, drum.grid.triangles);
    for (int v = 0; v < drum.grid.num_vertices(); ++v) {
        force[3 * v + 2] = areas[v];
    }
    const double sag = drum.skin().solve(force)(3 * free_columns(drum.held)[drum.middle()] + 2, 0);
    return sag * kTension / (kSide * kSide);
}

double drum_frequency(int n) {
    const Drum drum(n);
    const SkinModel skin = drum.skin();
    const auto mass = skin_mass(skin, drum.grid.vertices, drum.grid.triangles,
                                Eigen::VectorXd::Constant(drum.grid.num_vertices(), kDensity));
    return vibration_modes(skin.stiffness(), mass, 1).frequencies[0];
}

}  // namespace

std::vector<Benchmark> membrane_benchmarks() {
    const double frequency = std::sqrt(2 * kTension / kDensity) / (2 * kSide);
    return {
        {"cook",
         "Cook's membrane",
         Element::skin,
         "rise of the right edge's middle",
         23.96,
         "Cook 1974; fine meshes 23.96",
         {8, 16, 32, 64},
         32,
         0.03,
         cook},
        {"drum_sag",
         "Tense square under pressure",
         Element::skin,
         "middle, p L^2 / T",
         0.0736713,
         "Timoshenko and Goodier, torsion",
         {8, 16, 32, 64},
         32,
         0.03,
         drum_sag},
        {"drum_frequency",
         "Tense square, lowest tone",
         Element::skin,
         "Hz",
         frequency,
         "Rayleigh",
         {8, 16, 32, 64},
         32,
         0.03,
         drum_frequency},
    };
}

}  // namespace mimetic::validation
