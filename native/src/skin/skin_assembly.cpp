// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin_assembly.hpp"

#include <Eigen/Geometry>

#include "galerkin_product.hpp"

namespace mimetic {
namespace {

double mean(const Eigen::VectorXd& values, const Eigen::RowVector3i& face) {
    return (values[face[0]] + values[face[1]] + values[face[2]]) / 3;
}

}  // namespace

std::vector<SkinTriangle> make_skin_triangles(PointsIn vertices, TrianglesIn triangles) {
    std::vector<SkinTriangle> elements;
    elements.reserve(triangles.rows());
    for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
        elements.push_back(make_skin_triangle(vertices, triangles.row(f)));
    }
    return elements;
}

VertexFrames make_frames(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
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

void add_membrane(const std::vector<SkinTriangle>& elements, TrianglesIn triangles, const SkinMaterials& m,
                  BlockRows& nodal) {
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Eigen::RowVector3i face = triangles.row(f);
        const double thickness = mean(m.thickness, face);
        const Matrix9 stiffness =
            membrane_stiffness(elements[f], mean(m.young, face), mean(m.poisson, face), thickness) +
            pre_stress_stiffness(elements[f], mean(m.pre_stress, face) * thickness);
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                nodal.at(face[a], face[b]) += stiffness.block<3, 3>(3 * a, 3 * b);
            }
        }
    }
}

std::vector<Eigen::Matrix3d> assemble_foundation(const SkinMaterials& materials, const VertexFrames& frames) {
    std::vector<Eigen::Matrix3d> foundation(frames.areas.size());
    for (Eigen::Index v = 0; v < frames.areas.size(); ++v) {
        foundation[v] = foundation_stiffness(frames.areas[v], frames.normals.row(v), materials.tangential[v],
                                             materials.normal[v]);
    }
    return foundation;
}

Columns block_diagonal(const std::vector<Eigen::Matrix3d>& blocks) {
    Triplets entries;
    entries.reserve(9 * blocks.size());
    for (std::size_t v = 0; v < blocks.size(); ++v) {
        for (int a = 0; a < 9; ++a) {
            entries.emplace_back(3 * static_cast<int>(v) + a / 3, 3 * static_cast<int>(v) + a % 3,
                                 blocks[v](a / 3, a % 3));
        }
    }
    Columns result(3 * blocks.size(), 3 * blocks.size());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

Points curvature_change(const std::vector<SkinTriangle>& elements, TrianglesIn triangles,
                        const VertexFrames& frames, const VertexLists& rings) {
    Points curvature = Points::Zero(frames.areas.size(), 3);
    for (std::size_t f = 0; f < elements.size(); ++f) {
        const Eigen::Matrix3d share = curvature_share(elements[f]);
        for (int i = 0; i < 3; ++i) {
            curvature.row(triangles(f, i)) += share.row(i);
        }
    }
    Points change = Points::Zero(static_cast<Eigen::Index>(rings.vertex.size()), 3);
    for (std::size_t f = 0; f < elements.size(); ++f) {
        for (int i = 0; i < 3; ++i) {
            const int v = triangles(f, i);
            const Eigen::Matrix<double, 1, 9> row =
                curvature_row(elements[f], i, frames.normals.row(v), curvature.row(v), frames.areas[v]);
            for (int k = 0; k < 3; ++k) {
                change.row(rings.place(v, triangles(f, k))) += row.segment<3>(3 * k);
            }
        }
    }
    return change;
}

void add_bending(const Points& curvature_change, const Eigen::VectorXd& flexures, const VertexLists& rings,
                 BlockRows& nodal) {
    std::vector<int> place(rings.start.size());
    for (int row = 0; row < rings.size(); ++row) {
        for (int i = nodal.columns.start[row]; i < nodal.columns.start[row + 1]; ++i) {
            place[nodal.columns.vertex[i]] = i;
        }
        // The vertices whose curvature depends on this one are those of its ring
        for (const int v : rings.of(row)) {
            const Eigen::Vector3d moment =
                flexures[v] * curvature_change.row(rings.place(v, row)).transpose();
            for (int i = rings.start[v]; i < rings.start[v + 1]; ++i) {
                nodal.blocks[place[rings.vertex[i]]] += moment * curvature_change.row(i);
            }
        }
    }
}

Eigen::VectorXd flexure(const SkinMaterials& m, const VertexFrames& frames,
                        const std::vector<bool>& on_boundary) {
    Eigen::VectorXd result(frames.areas.size());
    for (Eigen::Index v = 0; v < result.size(); ++v) {
        result[v] =
            on_boundary[v] ? 0 : bending_stiffness(frames.areas[v], m.young[v], m.poisson[v], m.thickness[v]);
    }
    return result;
}

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

SkinMatrices assemble_skin(PointsIn vertices, TrianglesIn triangles, const SkinMaterials& materials,
                           const SparseRows& basis, const std::vector<bool>& on_boundary) {
    const std::vector<SkinTriangle> elements = make_skin_triangles(vertices, triangles);
    const VertexFrames frames = make_frames(elements, triangles, vertices.rows());
    SkinMatrices skin{interleave(basis), {}, assemble_foundation(materials, frames)};
    const VertexLists rings = vertex_rings(triangles, vertices.rows());
    BlockRows nodal(second_rings(rings));
    add_membrane(elements, triangles, materials, nodal);
    add_bending(curvature_change(elements, triangles, frames, rings), flexure(materials, frames, on_boundary),
                rings, nodal);
    for (int v = 0; v < rings.size(); ++v) {
        nodal.at(v, v) += skin.foundation[v];
    }
    skin.stiffness = galerkin_product(nodal, basis);
    return skin;
}

}  // namespace mimetic
