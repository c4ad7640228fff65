// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "benchmark.hpp"
#include "grid.hpp"

namespace mimetic::validation {
namespace {

constexpr double kDecay = 0.02;  // sqrt(E t / ((1 - nu^2) k_t))
constexpr double kYoung = 40e3;
constexpr double kThickness = 1.5e-3;

/// Pull on the end of a strip of skin; the length over which it decays, from the ends of the first two.
double decay_length(int per_length) {
    const Grid grid = make_grid(10 * per_length, 2, [&](double s, double t) -> Eigen::Vector3d {
        return {10 * kDecay * s, 2 * kDecay / per_length * t, 0};
    });
    SkinMaterials materials = even_skin(grid.num_vertices(), kYoung, 0, kThickness);
    materials.tangential.setConstant(kYoung * kThickness / (kDecay * kDecay));
    materials.normal.setConstant(1e6);
    const SkinModel skin(grid.vertices, grid.triangles, materials,
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    for (int row = 0; row <= 2; ++row) {
        force[3 * grid.at(0, row)] = row == 1 ? 0.5 : 0.25;
    }
    const Eigen::MatrixXd u = skin.solve(force);
    return 2 * kDecay / std::log(u(3 * grid.at(0, 1), 0) / u(3 * grid.at(2 * per_length, 1), 0));
}

/// Displacement along a unit pull at one point of an endless sheet on its foundation, at a place ahead (x)
/// and aside (y): the sheet's Green's function, by its two decay lengths, of stretch and of shear.
double pull_theory(double x, double y, double stretch, double shear, double tangential) {
    const double stretch_length = std::sqrt(stretch / tangential);
    const double shear_length = std::sqrt(shear / tangential);
    const double r = std::hypot(x, y);
    const double cos2 = x * x / (r * r);
    // Second derivative along x of K0(r / length).
    const auto second = [&](double length) {
        const double q = r / length;
        const double k0 = std::cyl_bessel_k(0, q);
        const double k1 = std::cyl_bessel_k(1, q);
        return ((k0 + k1 / q) * cos2 - k1 / q * (1 - cos2)) / (length * length);
    };
    return (std::cyl_bessel_k(0, r / shear_length) / shear +
            (second(stretch_length) - second(shear_length)) / tangential) /
           (2 * std::numbers::pi);
}

/// Pull at one vertex of a sheet: the decay length whose theory fits the displacements between a half and two
/// and a half decay lengths away best.
double spread_length(int per_length) {
    constexpr double kPoisson = 0.45;
    constexpr int kHalf = 6;  // decay lengths from the pull to the edge
    const Grid grid =
        make_grid(2 * kHalf * per_length, 2 * kHalf * per_length, [](double s, double t) -> Eigen::Vector3d {
            return {2 * kHalf * kDecay * (s - 0.5), 2 * kHalf * kDecay * (t - 0.5), 0};
        });
    const double stretch = kYoung * kThickness / (1 - kPoisson * kPoisson);
    const double shear = kYoung * kThickness / (2 * (1 + kPoisson));
    SkinMaterials materials = even_skin(grid.num_vertices(), kYoung, kPoisson, kThickness);
    materials.tangential.setConstant(stretch / (kDecay * kDecay));
    materials.normal.setConstant(1e6);
    const SkinModel skin(grid.vertices, grid.triangles, materials,
                         free_basis(std::vector<bool>(grid.num_vertices(), false)));
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * grid.num_vertices());
    force[3 * grid.at(kHalf * per_length, kHalf * per_length)] = 1;
    const Eigen::MatrixXd u = skin.solve(force);
    const auto misfit = [&](double length) {
        double sum = 0;
        for (int v = 0; v < grid.num_vertices(); ++v) {
            const Eigen::RowVector3d p = grid.vertices.row(v);
            if (p.norm() > 0.5 * kDecay && p.norm() < 2.5 * kDecay) {
                sum += std::pow(
                    u(3 * v, 0) - pull_theory(p.x(), p.y(), stretch, shear, stretch / (length * length)), 2);
            }
        }
        return sum;
    };
    double low = kDecay / 3;
    double high = 3 * kDecay;
    while (high - low > 1e-6 * kDecay) {  // golden section
        const double a = high - (high - low) / std::numbers::phi;
        const double b = low + (high - low) / std::numbers::phi;
        (misfit(a) < misfit(b) ? high : low) = misfit(a) < misfit(b) ? b : a;
    }
    return (low + high) / 2;
}

}  // namespace

std::vector<Benchmark> foundation_benchmarks() {
    return {
        {"winkler_decay",
         "Membrane on a foundation, pulled at its end",
         Element::skin,
         "decay length, m",
         kDecay,
         "exp(-x / length)",
         {1, 2, 4, 8},
         4,
         0.02,
         decay_length},
        {"spread",
         "Sheet on a foundation, pulled at one point",
         Element::skin,
         "spread length, m",
         kDecay,
         "Green's function, Bessel K0 and K1",
         {1, 2, 4, 8},
         4,
         0.03,
         spread_length},
    };
}

}  // namespace mimetic::validation
