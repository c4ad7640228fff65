// SPDX-License-Identifier: GPL-3.0-or-later
#include <opensubdiv/far/error.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <Eigen/Geometry>
#include <memory>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/surface.hpp>
#include <string>
#include <vector>

#include "check_faces.hpp"

namespace mimetic {
namespace {

namespace far = OpenSubdiv::Far;
using RefinerFactory = far::TopologyRefinerFactory<far::TopologyDescriptor>;
using StencilFactory = far::LimitStencilTableFactoryReal<double>;

// Enough that a patch next to a vertex of valence 8 is exact to single precision at face corners and edges.
constexpr int kIsolationLevel = 5;

thread_local std::string opensubdiv_message;

// OpenSubdiv prints to the terminal unless told otherwise.
void collect_opensubdiv_messages() {
    static const bool installed = [] {
        far::SetErrorCallback([](far::ErrorType, const char* text) { opensubdiv_message = text; });
        far::SetWarningCallback([](const char* text) { opensubdiv_message = text; });
        return true;
    }();
    (void)installed;
    opensubdiv_message.clear();
}

void check_places(QuadsIn faces, IndicesIn face_index, Points2In st) {
    if (face_index.size() != st.rows()) {
        throw InvalidInput("face_index has " + std::to_string(face_index.size()) + " entries, st has " +
                           std::to_string(st.rows()) + " rows: give one (s, t) for each");
    }
    for (Eigen::Index i = 0; i < st.rows(); ++i) {
        if (face_index[i] < 0 || face_index[i] >= faces.rows()) {
            throw InvalidInput("point " + std::to_string(i) + " lies on face " +
                               std::to_string(face_index[i]) + ", the mesh has " +
                               std::to_string(faces.rows()) + " faces");
        }
        const auto place = st.row(i).array();
        if (!((place >= 0).all() && (place <= 1).all())) {
            throw InvalidInput("point " + std::to_string(i) + " has (s, t) outside [0, 1]");
        }
    }
}

/// Vertices in use get consecutive numbers: OpenSubdiv warns about the others.
struct Compacted {
    std::vector<int> corners;
    std::vector<int> vertex;  // compact -> given
};

Compacted compact(QuadsIn faces, int num_vertices) {
    Compacted result;
    std::vector<int> number(num_vertices, -1);
    result.corners.reserve(faces.size());
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int k = 0; k < 4; ++k) {
            int& n = number[faces(f, k)];
            if (n < 0) {
                n = static_cast<int>(result.vertex.size());
                result.vertex.push_back(faces(f, k));
            }
            result.corners.push_back(n);
        }
    }
    return result;
}

std::unique_ptr<far::TopologyRefiner> make_refiner(const Compacted& mesh) {
    const std::vector<int> sizes(mesh.corners.size() / 4, 4);
    far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(mesh.vertex.size());
    descriptor.numFaces = static_cast<int>(sizes.size());
    descriptor.numVertsPerFace = sizes.data();
    descriptor.vertIndicesPerFace = mesh.corners.data();
    OpenSubdiv::Sdc::Options options;
    options.SetVtxBoundaryInterpolation(OpenSubdiv::Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    std::unique_ptr<far::TopologyRefiner> refiner(RefinerFactory::Create(
        descriptor, RefinerFactory::Options(OpenSubdiv::Sdc::SCHEME_CATMARK, options)));
    if (!refiner) {
        throw InvalidInput("the faces do not form a mesh that can be subdivided: " + opensubdiv_message);
    }
    refiner->RefineAdaptive(far::TopologyRefiner::AdaptiveOptions(kIsolationLevel));
    return refiner;
}

}  // namespace

void check_faces(QuadsIn faces, int num_vertices) {
    if (faces.rows() == 0) {
        throw InvalidInput("the mesh has no faces");
    }
    check_corners(faces, num_vertices);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int k = 0; k < 4; ++k) {
            const int vertex = faces(f, k);
            for (int other = 0; other < k; ++other) {
                if (faces(f, other) == vertex) {
                    throw InvalidInput("face " + std::to_string(f) + " has vertex " + std::to_string(vertex) +
                                       " twice: a quad needs four different vertices");
                }
            }
        }
    }
}

LimitSurface::LimitSurface(QuadsIn faces, int num_vertices, IndicesIn face_index, Points2In st) {
    check_faces(faces, num_vertices);
    check_places(faces, face_index, st);
    collect_opensubdiv_messages();
    const Compacted mesh = compact(faces, num_vertices);
    const auto refiner = make_refiner(mesh);
    StencilFactory::LocationArrayVec places(st.rows());
    const Eigen::VectorXd s = st.col(0);
    const Eigen::VectorXd t = st.col(1);
    for (Eigen::Index i = 0; i < st.rows(); ++i) {
        places[i].ptexIdx = face_index[i];  // all faces are quads, so ptex faces are the faces
        places[i].numLocations = 1;
        places[i].s = &s[i];
        places[i].t = &t[i];
    }
    std::unique_ptr<const far::LimitStencilTableReal<double>> table(StencilFactory::Create(*refiner, places));
    if (st.rows() > 0 && (!table || table->GetNumStencils() != st.rows())) {
        throw InvalidInput("the limit surface could not be evaluated: " + opensubdiv_message);
    }
    for (SparseRows* matrix : {&position_, &s_tangent_, &t_tangent_}) {
        matrix->resize(st.rows(), num_vertices);
    }
    std::vector<Eigen::Triplet<double>> position;
    std::vector<Eigen::Triplet<double>> ds;
    std::vector<Eigen::Triplet<double>> dt;
    for (int i = 0; i < st.rows(); ++i) {
        const auto stencil = table->GetLimitStencil(i);
        for (int k = 0; k < stencil.GetSize(); ++k) {
            const int vertex = mesh.vertex[stencil.GetVertexIndices()[k]];
            position.emplace_back(i, vertex, stencil.GetWeights()[k]);
            ds.emplace_back(i, vertex, stencil.GetDuWeights()[k]);
            dt.emplace_back(i, vertex, stencil.GetDvWeights()[k]);
        }
    }
    position_.setFromTriplets(position.begin(), position.end());
    s_tangent_.setFromTriplets(ds.begin(), ds.end());
    t_tangent_.setFromTriplets(dt.begin(), dt.end());
}

namespace {

void check_vertices(PointsIn vertices, int num_vertices) {
    if (vertices.rows() != num_vertices) {
        throw InvalidInput("got " + std::to_string(vertices.rows()) + " vertices for a mesh of " +
                           std::to_string(num_vertices));
    }
}

}  // namespace

Points LimitSurface::positions(PointsIn vertices) const {
    check_vertices(vertices, num_vertices());
    return position_ * vertices;
}

Points LimitSurface::normals(PointsIn vertices) const {
    check_vertices(vertices, num_vertices());
    const Points ds = s_tangent_ * vertices;
    const Points dt = t_tangent_ * vertices;
    Points normals(num_points(), 3);
    for (int i = 0; i < num_points(); ++i) {
        const Eigen::Vector3d cross = ds.row(i).transpose().cross(dt.row(i).transpose());
        const double length = cross.norm();
        const bool has_plane = length > 1e-12 * ds.row(i).norm() * dt.row(i).norm();
        normals.row(i) = (has_plane ? 1 / length : 0.0) * cross;
    }
    return normals;
}

}  // namespace mimetic
