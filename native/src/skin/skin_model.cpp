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

/// Rotation vector of the element for a displacement of corner `i`: 3 x 3.
Eigen::Matrix3d rotation_of(const Triangle& t, int i) {
    const Eigen::Vector3d turned = t.normal.cross(Eigen::Vector3d(t.axes.transpose() * t.slope.col(i)));
    return t.normal * turned.transpose() / 2 - turned * t.normal.transpose();
}

struct VertexFrames {
    Eigen::VectorXd areas;  // a third of the triangles around
    Points normals;         // unit
};

VertexFrames make_frames(const std::vector<Triangle>& elements, TrianglesIn triangles,
                         Eigen::Index num_vertices) {
    VertexFrames frames{Eigen::VectorXd::Zero(num_vertices), Points::Zero(num_vertices, 3)};
    for (std::size_t f = 0; f < elements.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            frames.areas[triangles(f, k)] += elements[f].area / 3;
            frames.normals.row(triangles(f, k)) += elements[f].area * elements[f].normal.transpose();
        }
    }
    frames.normals.rowwise().normalize();
    return frames;
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
    for (Eigen::Index k = 0; k < 3; ++k) {
        Eigen::Matrix<double, 3, 2> plane;
        plane << t.slope(0, k), 0, 0, t.slope(1, k), t.slope(1, k), t.slope(0, k);
        strain.middleCols<3>(3 * k) = plane * t.axes;
    }
    Eigen::Matrix<double, 9, 9> stiffness = t.area * thickness * strain.transpose() * elastic * strain;
    // A stressed membrane resists leaving its plane.
    const Eigen::Matrix3d coupling =
        mean(m.pre_stress, face) * thickness * t.area * t.slope.transpose() * t.slope;
    const Eigen::Matrix3d outwards = t.normal * t.normal.transpose();
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
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

    Columns assemble_membrane(const std::vector<Triangle>& elements, TrianglesIn triangles,
                              const SkinMaterials& materials, const VertexFrames& frames);
};

namespace {

/// Change of the mean-curvature vector along the normal, N x 3N (times the vertex's area). Turning the
/// surface turns that vector without bending anything, so the turn of the surrounding elements is taken off.
Columns curvature_change(const std::vector<Triangle>& elements, TrianglesIn triangles, PointsIn vertices,
                         const VertexFrames& frames) {
    Points curvature = Points::Zero(vertices.rows(), 3);
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Triangle& t = elements[f];
        const Eigen::Matrix3d pull = t.area * t.slope.transpose() * t.slope * t.corners.transpose();
        for (int i = 0; i < 3; ++i) {
            curvature.row(triangles(f, i)) += pull.row(i);
        }
    }
    Triplets entries;
    entries.reserve(27 * elements.size());
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Triangle& t = elements[f];
        const Eigen::Matrix3d cotangent = t.area * t.slope.transpose() * t.slope;
        for (int i = 0; i < 3; ++i) {
            const int v = triangles(f, i);
            const Eigen::RowVector3d normal = frames.normals.row(v);
            const Eigen::RowVector3d tilt = curvature.row(v).cross(normal) * (t.area / 3 / frames.areas[v]);
            for (int j = 0; j < 3; ++j) {
                const Eigen::RowVector3d row = cotangent(i, j) * normal - tilt * rotation_of(t, j);
                for (int axis = 0; axis < 3; ++axis) {
                    entries.emplace_back(v, 3 * triangles(f, j) + axis, row[axis]);
                }
            }
        }
    }
    Columns change(vertices.rows(), 3 * vertices.rows());
    change.setFromTriplets(entries.begin(), entries.end());
    return change;
}

/// Plate stiffness over area; a free edge carries no moment.
Eigen::VectorXd flexure(const SkinMaterials& materials, const VertexFrames& frames,
                        const std::vector<bool>& on_boundary) {
    Eigen::VectorXd result(frames.areas.size());
    for (Eigen::Index v = 0; v < result.size(); ++v) {
        const double plate = materials.young[v] * std::pow(materials.thickness[v], 3) / 12 /
                             (1 - materials.poisson[v] * materials.poisson[v]);
        result[v] = on_boundary[v] ? 0 : plate / frames.areas[v];
    }
    return result;
}

}  // namespace

Columns SkinModel::Parts::assemble_membrane(const std::vector<Triangle>& elements, TrianglesIn triangles,
                                            const SkinMaterials& materials, const VertexFrames& frames) {
    Triplets entries;
    entries.reserve(81 * elements.size() + 9 * frames.areas.size());
    const auto add = [&](int row, int column, const Eigen::Matrix3d& block) {
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                entries.emplace_back(3 * row + a, 3 * column + b, block(a, b));
            }
        }
    };
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const auto stiffness_e = membrane_stiffness(elements[f], materials, triangles.row(f));
        for (Eigen::Index i = 0; i < 3; ++i) {
            for (Eigen::Index j = 0; j < 3; ++j) {
                add(triangles(f, i), triangles(f, j), stiffness_e.block<3, 3>(3 * i, 3 * j));
            }
        }
    }
    foundation.resize(frames.areas.size());
    for (Eigen::Index v = 0; v < frames.areas.size(); ++v) {
        const Eigen::Vector3d n = frames.normals.row(v);
        foundation[v] =
            frames.areas[v] * (materials.tangential[v] * Eigen::Matrix3d::Identity() +
                               (materials.normal[v] - materials.tangential[v]) * n * n.transpose());
        add(static_cast<int>(v), static_cast<int>(v), foundation[v]);
    }
    Columns nodal(3 * frames.areas.size(), 3 * frames.areas.size());
    nodal.setFromTriplets(entries.begin(), entries.end());
    return nodal;
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
    std::vector<Triangle> elements;
    elements.reserve(triangles.rows());
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        elements.push_back(make_triangle(vertices, triangles.row(f)));
    }
    const VertexFrames frames = make_frames(elements, triangles, vertices.rows());
    const Columns force = parts_->assemble_membrane(elements, triangles, materials, frames) * parts_->basis;
    const SparseRows bend = curvature_change(elements, triangles, vertices, frames) * parts_->basis;
    const SparseRows moment = flexure(materials, frames, on_boundary).asDiagonal() * bend;
    parts_->stiffness = Columns(parts_->basis.transpose() * force) + Columns(bend.transpose() * moment);
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
