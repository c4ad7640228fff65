// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <limits>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/skin/corotational_skin.hpp>
#include <string>
#include <utility>

#include "check_mesh.hpp"
#include "cholesky.hpp"
#include "corotational_element.hpp"
#include "skin_assembly.hpp"

namespace mimetic {
namespace {

constexpr int kMaxHalvings = 30;

double mean(const Eigen::VectorXd& values, const Eigen::RowVector3i& face) {
    return (values[face[0]] + values[face[1]] + values[face[2]]) / 3;
}

/// Pre-stress and foundation over the vertices' displacements, 3N x 3N: linear at every rotation.
Columns assemble_linear_part(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
                             const SkinMaterials& m, const VertexFrames& frames) {
    Triplets entries;
    entries.reserve(81 * elements.size());
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        const Matrix9 stiffness =
            pre_stress_stiffness(elements[f], mean(m.pre_stress, face) * mean(m.thickness, face));
        for (int a = 0; a < 9; ++a) {
            for (int b = 0; b < 9; ++b) {
                entries.emplace_back(3 * face[a / 3] + a % 3, 3 * face[b / 3] + b % 3, stiffness(a, b));
            }
        }
    }
    Columns nodal(3 * frames.areas.size(), 3 * frames.areas.size());
    nodal.setFromTriplets(entries.begin(), entries.end());
    return nodal + block_diagonal(assemble_foundation(m, frames));
}

Eigen::VectorXd flat(const Points& points) {
    return Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
}

/// Directions of descent from the last steps (L-BFGS), for an inverse Hessian that is known at the start.
class StepMemory {
public:
    void add(Eigen::VectorXd step, Eigen::VectorXd change) {
        const double work = step.dot(change);
        if (!(work > 0)) {
            return;  // no positive curvature: the pair is skipped
        }
        pairs_.push_back({std::move(step), std::move(change), work});
        if (pairs_.size() > kKept) {
            pairs_.pop_front();
        }
    }

    Eigen::VectorXd direction(const Cholesky& metric, Eigen::VectorXd force) const {
        std::vector<double> shares(pairs_.size());
        for (std::size_t i = pairs_.size(); i-- > 0;) {
            shares[i] = pairs_[i].step.dot(force) / pairs_[i].work;
            force -= shares[i] * pairs_[i].change;
        }
        Eigen::VectorXd result = metric.solve(force);
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            result += (shares[i] - pairs_[i].change.dot(result) / pairs_[i].work) * pairs_[i].step;
        }
        return result;
    }

private:
    struct Pair {
        Eigen::VectorXd step, change;
        double work;
    };
    static constexpr std::size_t kKept = 10;
    std::deque<Pair> pairs_;
};

}  // namespace

void CorotationalOptions::check() const {
    check_range("max_iterations", max_iterations, 1, 100000);
    check_range("tolerance", tolerance, 1e-12, 1);
}

struct CorotationalSkin::Parts {
    SkinModel linear;
    Cholesky factor;
    Points rest;
    Triangles triangles;
    std::vector<SkinTriangle> elements;
    VertexFrames frames;
    Eigen::ArrayXd young, poisson, thickness;  // a triangle
    Eigen::VectorXd flexure;                   // a vertex
    Eigen::VectorXd rest_curvature;            // along the normal, times the area
    Columns linear_part;                       // 3C x 3C: pre-stress and foundation

    struct Moved {
        std::vector<TurnedTriangle> turned;
        Points normals;    // turned with the triangles around
        Points curvature;  // mean-curvature vector times area
        bool crushed = false;
    };

    Points positions(VectorIn unknowns) const {
        if (unknowns.size() != linear.basis().cols()) {
            throw InvalidInput("got " + std::to_string(unknowns.size()) + " unknowns, needed are " +
                               std::to_string(linear.basis().cols()));
        }
        const Eigen::VectorXd moved = flat(rest) + linear.basis() * unknowns;
        return Eigen::Map<const Points>(moved.data(), rest.rows(), 3);
    }

    Moved move(const Points& now) const;
    double element_energy(const Moved& moved) const;
    Points element_gradient(const Moved& moved) const;
    Eigen::VectorXd bending(const Moved& moved) const {
        return moved.normals.cwiseProduct(moved.curvature).rowwise().sum() - rest_curvature;
    }
    Eigen::Matrix3Xd rest_normals() const {
        Eigen::Matrix3Xd normals(3, elements.size());
        for (std::size_t f = 0; f < elements.size(); ++f) {
            normals.col(f) = elements[f].normal;
        }
        return normals;
    }
    struct Reached {
        double energy;
        Eigen::VectorXd gradient;  // empty where the energy is infinite
        Eigen::Matrix3Xd normals;  // a column a triangle
    };
    Reached reach(VectorIn unknowns) const {
        const Moved moved = move(positions(unknowns));
        if (moved.crushed) {
            return {std::numeric_limits<double>::infinity(), {}, {}};
        }
        Eigen::Matrix3Xd normals(3, elements.size());
        for (std::size_t f = 0; f < elements.size(); ++f) {
            normals.col(f) = moved.turned[f].normal;
        }
        const Eigen::VectorXd force = linear_part * unknowns;
        return {element_energy(moved) + unknowns.dot(force) / 2,
                linear.basis().transpose() * flat(element_gradient(moved)) + force, std::move(normals)};
    }
};

CorotationalSkin::Parts::Moved CorotationalSkin::Parts::move(const Points& now) const {
    Moved moved{{}, Points::Zero(now.rows(), 3), Points::Zero(now.rows(), 3)};
    moved.turned.reserve(elements.size());
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const SkinTriangle& t = elements[f];
        Eigen::Matrix3d corners;
        for (int k = 0; k < 3; ++k) {
            corners.col(k) = now.row(triangles(f, k));
        }
        const TurnedTriangle& turned = moved.turned.emplace_back(t, corners);
        if (turned.crushed) {
            moved.crushed = true;
            return moved;
        }
        const Eigen::Matrix3d rotation = turned.rotation(t);
        const Eigen::Matrix3d share = t.area * t.slope.transpose() * t.slope * corners.transpose();
        for (int i = 0; i < 3; ++i) {
            const int v = triangles(f, i);
            moved.curvature.row(v) += share.row(i);
            moved.normals.row(v) +=
                t.area / 3 / frames.areas[v] * (rotation * frames.normals.row(v).transpose());
        }
    }
    return moved;
}

double CorotationalSkin::Parts::element_energy(const Moved& moved) const {
    double sum = flexure.dot(bending(moved).cwiseAbs2()) / 2;
    for (std::size_t f = 0; f < elements.size(); ++f) {
        sum += elements[f].area * thickness[f] *
               MembraneState(moved.turned[f].stretch, young[f], poisson[f]).energy;
    }
    return sum;
}

Points CorotationalSkin::Parts::element_gradient(const Moved& moved) const {
    const Eigen::VectorXd moment = flexure.cwiseProduct(bending(moved));
    Points gradient = Points::Zero(rest.rows(), 3);
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const SkinTriangle& t = elements[f];
        const TurnedTriangle& turned = moved.turned[f];
        const MembraneState membrane(turned.stretch, young[f], poisson[f]);
        const Eigen::Matrix<double, 3, 2> stress = t.area * thickness[f] * turned.axes * membrane.stress;
        const Eigen::Matrix3d rotation = turned.rotation(t);
        const Eigen::Matrix3d cotangent = t.area * t.slope.transpose() * t.slope;
        Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // on the triangle's rotation
        Eigen::Matrix3d pulls = Eigen::Matrix3d::Zero();   // a column a corner
        for (int i = 0; i < 3; ++i) {
            const int v = triangles(f, i);
            const Eigen::Vector3d normal = rotation * frames.normals.row(v).transpose();
            const Eigen::Vector3d curvature = moved.curvature.row(v);
            torque += moment[v] * t.area / 3 / frames.areas[v] * normal.cross(curvature);
            pulls += moment[v] * moved.normals.row(v).transpose() * cotangent.row(i);
        }
        for (int j = 0; j < 3; ++j) {
            gradient.row(triangles(f, j)) +=
                stress * t.slope.col(j) + pulls.col(j) + turned.rotation_of(t, j).transpose() * torque;
        }
    }
    return gradient;
}

CorotationalSkin::CorotationalSkin(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                                   const SparseRows& basis)
    : parts_(new Parts{SkinModel(vertices, triangles, materials, basis),
                       {},
                       vertices,
                       triangles,
                       {},
                       {},
                       {},
                       {},
                       {},
                       {},
                       {},
                       {}}) {
    Parts& p = *parts_;
    p.factor.compute(p.linear.stiffness());
    p.elements = make_skin_triangles(vertices, triangles);
    p.frames = make_frames(p.elements, triangles, vertices.rows());
    p.young.resize(triangles.rows());
    p.poisson.resize(triangles.rows());
    p.thickness.resize(triangles.rows());
    Points curvature = Points::Zero(vertices.rows(), 3);
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        p.young[f] = mean(materials.young, face);
        p.poisson[f] = mean(materials.poisson, face);
        p.thickness[f] = mean(materials.thickness, face);
        const Eigen::Matrix3d share = curvature_share(p.elements[f]);
        for (int i = 0; i < 3; ++i) {
            curvature.row(face[i]) += share.row(i);
        }
    }
    p.rest_curvature = p.frames.normals.cwiseProduct(curvature).rowwise().sum();
    p.flexure = flexure(materials, p.frames, check_mesh(vertices, triangles));
    const Columns& spread = p.linear.basis();
    p.linear_part = spread.transpose() *
                    Columns(assemble_linear_part(p.elements, triangles, materials, p.frames) * spread);
}

CorotationalSkin::~CorotationalSkin() = default;
CorotationalSkin::CorotationalSkin(CorotationalSkin&&) noexcept = default;
CorotationalSkin& CorotationalSkin::operator=(CorotationalSkin&&) noexcept = default;

const SkinModel& CorotationalSkin::linear() const { return parts_->linear; }
double CorotationalSkin::energy(VectorIn unknowns) const { return parts_->reach(unknowns).energy; }

Eigen::VectorXd CorotationalSkin::gradient(VectorIn unknowns) const {
    Parts::Reached reached = parts_->reach(unknowns);
    if (reached.gradient.size() == 0) {
        throw InvalidInput("a triangle of the skin has no area left");
    }
    return std::move(reached.gradient);
}

CorotationalSolution CorotationalSkin::solve(VectorIn forces, const CorotationalOptions& options) const {
    options.check();
    const Columns& basis = parts_->linear.basis();
    if (forces.size() != basis.rows()) {
        throw InvalidInput("got " + std::to_string(forces.size()) + " forces, needed are " +
                           std::to_string(basis.rows()));
    }
    if (parts_->factor.info() != Eigen::Success) {
        throw InvalidInput("the skin can move freely: attach it to bone or hold some of its vertices");
    }
    const Eigen::VectorXd load = basis.transpose() * forces;
    CorotationalSolution solution{Eigen::VectorXd::Zero(load.size())};
    Eigen::VectorXd& u = solution.unknowns;
    Eigen::VectorXd left = load;  // nothing moves yet
    double height = 0;
    Eigen::Matrix3Xd normals = parts_->rest_normals();
    StepMemory memory;
    const double scale = std::max(load.norm(), std::numeric_limits<double>::min());
    for (;; ++solution.iterations) {
        solution.residual = left.norm() / scale;
        solution.converged = solution.residual <= options.tolerance;
        if (solution.converged || solution.iterations == options.max_iterations) {
            return solution;
        }
        Eigen::VectorXd step = memory.direction(parts_->factor, left);
        Parts::Reached next = parts_->reach(u + step);
        // Rounding of the energy hides the last gains: accept them
        const double noise = 1e-12 * std::abs(height);
        const auto is_good = [&] {
            // A triangle that turned by more than a right angle may have passed through itself
            return next.normals.cols() > 0 &&
                   next.normals.cwiseProduct(normals).colwise().sum().minCoeff() > 0 &&
                   next.energy - load.dot(u + step) <= height - 1e-4 * step.dot(left) + noise;
        };
        int halvings = 0;
        for (; !is_good() && halvings < kMaxHalvings; ++halvings) {
            step /= 2;
            next = parts_->reach(u + step);
        }
        if (halvings == kMaxHalvings) {
            return solution;  // as accurate as rounding allows
        }
        u += step;
        height = next.energy - load.dot(u);
        memory.add(step, next.gradient - load + left);
        left = load - next.gradient;
        normals = std::move(next.normals);
    }
}

}  // namespace mimetic
