// SPDX-License-Identifier: GPL-3.0-or-later
// The skin at the size of a head's (2,700 free control vertices, 17,500 vertices refined once): assembly,
// factorisation, a static solve beside CHOLMOD's own, a step in time whole and reduced, surface evaluation.
#include <benchmark/benchmark.h>

#include <cmath>
#include <mimetic/skin/corotational_skin.hpp>
#include <mimetic/skin/skin_dynamics.hpp>
#include <mimetic/surface/surface.hpp>

#include "skin/check_mesh.hpp"
#include "skin/cholesky.hpp"
#include "skin/skin_assembly.hpp"

namespace {

using namespace mimetic;

constexpr int kSide = 66;   // control vertices along a side
constexpr int kFree = 52;   // of which in the middle are not held
constexpr int kLoads = 39;  // 36 muscles and 3 motions of the jaw
constexpr int kModes = 8;   // the package's default
constexpr Eigen::Index kPlaces = 6000;

/// A square of skin bulging like a face, its rim held, with muscles pulling here and there.
struct Scene {
    Scene() {
        Quads quads((kSide - 1) * (kSide - 1), 4);
        Points control(kSide * kSide, 3);
        std::vector<Eigen::Triplet<double>> kept;
        const int margin = (kSide - kFree) / 2;
        for (int row = 0; row < kSide; ++row) {
            for (int column = 0; column < kSide; ++column) {
                const double x = 0.2 * column / (kSide - 1) - 0.1;
                const double y = 0.2 * row / (kSide - 1) - 0.1;
                control.row(row * kSide + column) << x, y, std::sqrt(0.03 - x * x - y * y);
                if (std::min({row, column, kSide - 1 - row, kSide - 1 - column}) >= margin) {
                    kept.emplace_back(row * kSide + column, static_cast<int>(kept.size()), 1.0);
                }
            }
        }
        for (int f = 0; f < quads.rows(); ++f) {
            const int a = f / (kSide - 1) * kSide + f % (kSide - 1);
            quads.row(f) << a, a + 1, a + kSide + 1, a + kSide;
        }
        const SubdividedMesh mesh(quads, kSide * kSide, 1);
        vertices = mesh.positions(control);
        triangles.resize(2 * mesh.faces().rows(), 3);
        for (int f = 0; f < mesh.faces().rows(); ++f) {
            const Eigen::RowVector4i q = mesh.faces().row(f);
            triangles.middleRows<2>(2 * f) << q[0], q[1], q[2], q[0], q[2], q[3];
        }
        SparseRows select(kSide * kSide, static_cast<Eigen::Index>(kept.size()));
        select.setFromTriplets(kept.begin(), kept.end());
        basis = mesh.stencils() * select;
        places = limit_places(quads, select);
        const auto all = [&](double value) -> Eigen::VectorXd {
            return Eigen::VectorXd::Constant(vertices.rows(), value);
        };
        materials = {all(40e3), all(0.49), all(1.5e-3), all(20e3), all(1e5), all(1e6)};
        density = all(3.2);
        forces = Eigen::MatrixXd::Zero(3 * vertices.rows(), kLoads);
        for (int load = 0; load < kLoads; ++load) {
            const Eigen::Vector2d at(0.07 * std::sin(7.0 * load), 0.07 * std::cos(3.0 * load));
            for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
                const double distance = (vertices.row(v).head<2>().transpose() - at).norm();
                forces(3 * v + load % 2, load) = 2e-3 * std::exp(-std::pow(distance / 0.006, 2) / 2);
            }
        }
    }

    /// 6,000 places spread over the middle of the limit surface: rows over the unknowns.
    static SparseRows limit_places(const Quads& quads, const SparseRows& select) {
        Eigen::VectorXi faces(kPlaces);
        Points2 st(kPlaces, 2);
        for (int i = 0; i < kPlaces; ++i) {
            const int row = (kSide - kFree) / 2 + i / 75 % 50;
            const int column = (kSide - kFree) / 2 + i % 75 * 50 / 75;
            faces[i] = row * (kSide - 1) + column;
            st.row(i) << std::fmod(0.37 * i, 1.0), std::fmod(0.61 * i, 1.0);
        }
        return LimitSurface(quads, kSide * kSide, faces, st).position_stencils() * select;
    }

    Points vertices;
    Triangles triangles;
    SparseRows basis, places;
    SkinMaterials materials;
    Eigen::VectorXd density;
    Eigen::MatrixXd forces;  // 3N x 39
};

const Scene& scene() {
    static const Scene made;
    return made;
}

const SkinModel& skin() {
    static const SkinModel made(scene().vertices, scene().triangles, scene().materials, scene().basis);
    return made;
}

const Eigen::SparseMatrix<double>& mass() {
    static const auto made = skin_mass(skin(), scene().vertices, scene().triangles, scene().density);
    return made;
}

DynamicsOptions options() {
    DynamicsOptions result;
    result.mass_damping = 19;
    result.stiffness_damping = 0.01;
    result.relaxation_share = 0.4;
    return result;
}

const Cholesky& factor() {
    static const Cholesky& made = *[] {
        static Cholesky held;
        held.compute(skin().stiffness());
        return &held;
    }();
    return made;
}

Eigen::VectorXd values(int frame) {
    return (Eigen::VectorXd::LinSpaced(kLoads, 0, 3).array() + 0.1 * frame).sin();
}

void check_mesh(benchmark::State& state) {
    for (auto _ : state) {
        benchmark::DoNotOptimize(mimetic::check_mesh(scene().vertices, scene().triangles));
    }
}

void assembly(benchmark::State& state) {
    const auto boundary = mimetic::check_mesh(scene().vertices, scene().triangles);
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            assemble_skin(scene().vertices, scene().triangles, scene().materials, scene().basis, boundary));
    }
    state.counters["unknowns"] = static_cast<double>(skin().stiffness().rows());
}

void factorisation(benchmark::State& state) {
    for (auto _ : state) {
        Cholesky made;
        made.compute(skin().stiffness());
        benchmark::DoNotOptimize(made.info());
    }
}

/// What the factorisation costs if its order is known already.
void floor_factorisation_numeric(benchmark::State& state) {
    Cholesky made;
    made.analyzePattern(skin().stiffness());
    for (auto _ : state) {
        made.factorize(skin().stiffness());
        benchmark::DoNotOptimize(made.info());
    }
}

void static_solve(benchmark::State& state) {
    for (auto _ : state) {
        benchmark::DoNotOptimize(skin().solve(scene().forces));
    }
}

/// CHOLMOD's triangular solves alone, on the same matrix and right-hand sides.
void floor_static_solve(benchmark::State& state) {
    Eigen::MatrixXd loads = skin().loads(scene().forces);
    cholmod_common common;
    cholmod_start(&common);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;
    common.supernodal = CHOLMOD_SUPERNODAL;
    const Eigen::SparseMatrix<double>& matrix = skin().stiffness();
    cholmod_sparse view = Eigen::viewAsCholmod(matrix.selfadjointView<Eigen::Lower>());
    cholmod_factor* analysed = cholmod_analyze(&view, &common);
    cholmod_factorize(&view, analysed, &common);
    cholmod_dense right = Eigen::viewAsCholmod(loads);
    for (auto _ : state) {
        cholmod_dense* solution = cholmod_solve(CHOLMOD_A, analysed, &right, &common);
        benchmark::DoNotOptimize(solution->x);
        cholmod_free_dense(&solution, &common);
    }
    cholmod_free_factor(&analysed, &common);
    cholmod_finish(&common);
}

void implicit_step(benchmark::State& state) {
    SkinDynamics dynamics(skin().stiffness(), mass(), options());
    const Eigen::MatrixXd loads = skin().loads(scene().forces);
    const Eigen::VectorXd load = loads.rowwise().sum();
    for (auto _ : state) {
        benchmark::DoNotOptimize(dynamics.advance(load));
    }
}

/// A step's linear system with nothing else.
void floor_implicit_step(benchmark::State& state) {
    const Eigen::VectorXd load = skin().loads(scene().forces).rowwise().sum();
    for (auto _ : state) {
        benchmark::DoNotOptimize(Eigen::VectorXd(factor().solve(load)));
    }
}

ReducedSkin make_reduced() {
    return ReducedSkin(skin().stiffness(), mass(), skin().loads(scene().forces), kModes, options());
}

void reduced_step(benchmark::State& state) {
    ReducedSkin reduced = make_reduced();
    const Eigen::VectorXd now = values(0);
    for (auto _ : state) {
        benchmark::DoNotOptimize(reduced.advance(now));
    }
    state.counters["coordinates"] = reduced.num_coordinates();
}

void surface_evaluation(benchmark::State& state) {
    ReducedSkin reduced = make_reduced();
    ReducedSurface surface(scene().places, reduced.shapes());
    const Eigen::VectorXd coordinates = reduced.advance(values(0));
    for (auto _ : state) {
        benchmark::DoNotOptimize(surface.displacements(coordinates));
    }
    state.counters["places"] = surface.num_places();
}

void reduced_step_and_surface(benchmark::State& state) {
    ReducedSkin reduced = make_reduced();
    ReducedSurface surface(scene().places, reduced.shapes());
    const Eigen::VectorXd now = values(0);
    for (auto _ : state) {
        benchmark::DoNotOptimize(surface.displacements(reduced.advance(now)));
    }
}

/// The same without folding: all unknowns from the coordinates, then the limit stencils.
void unfolded_surface_evaluation(benchmark::State& state) {
    ReducedSkin reduced = make_reduced();
    const Eigen::VectorXd coordinates = reduced.advance(values(0));
    for (auto _ : state) {
        const Eigen::VectorXd u = reduced.shapes() * coordinates;
        benchmark::DoNotOptimize(
            Points(scene().places * Eigen::Map<const Points>(u.data(), u.size() / 3, 3)));
    }
}

/// As many bytes as the folded matrix read once: no evaluation of it can be faster.
void floor_surface_evaluation(benchmark::State& state) {
    const Eigen::VectorXf field = Eigen::VectorXf::Ones(3 * kPlaces * (kLoads + kModes));
    for (auto _ : state) {
        benchmark::DoNotOptimize(field.sum());
    }
}

void corotational_gradient(benchmark::State& state) {
    const CorotationalSkin turning(scene().vertices, scene().triangles, scene().materials, scene().basis);
    const Eigen::VectorXd u = skin().solve(scene().forces.leftCols(1));
    for (auto _ : state) {
        benchmark::DoNotOptimize(turning.gradient(u));
    }
}

BENCHMARK(check_mesh)->Unit(benchmark::kMillisecond);
BENCHMARK(assembly)->Unit(benchmark::kMillisecond);
BENCHMARK(factorisation)->Unit(benchmark::kMillisecond);
BENCHMARK(floor_factorisation_numeric)->Unit(benchmark::kMillisecond);
BENCHMARK(static_solve)->Unit(benchmark::kMillisecond);
BENCHMARK(floor_static_solve)->Unit(benchmark::kMillisecond);
BENCHMARK(implicit_step)->Unit(benchmark::kMillisecond);
BENCHMARK(floor_implicit_step)->Unit(benchmark::kMillisecond);
BENCHMARK(reduced_step)->Unit(benchmark::kMicrosecond);
BENCHMARK(surface_evaluation)->Unit(benchmark::kMicrosecond);
BENCHMARK(reduced_step_and_surface)->Unit(benchmark::kMicrosecond);
BENCHMARK(unfolded_surface_evaluation)->Unit(benchmark::kMicrosecond);
BENCHMARK(floor_surface_evaluation)->Unit(benchmark::kMicrosecond);
BENCHMARK(corotational_gradient)->Unit(benchmark::kMillisecond);

}  // namespace
