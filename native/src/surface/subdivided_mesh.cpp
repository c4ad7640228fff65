// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/surface.hpp>
#include <string>
#include <vector>

#include "check_faces.hpp"

namespace mimetic {

namespace {

/// (side + 1)^2 vertices on each face; those on edges are shared between faces.
class Grid {
public:
    Grid(QuadsIn faces, int num_vertices, int side)
        : faces_(faces),
          side_(side),
          face_index_(num_vertices, -1),
          st_(num_vertices, Eigen::Vector2d::Zero()) {}

    /// Number of the vertex at column i, row j of a face's grid.
    int vertex(int face, int i, int j) {
        const bool on_column = i == 0 || i == side_;
        const bool on_row = j == 0 || j == side_;
        if (on_column && on_row) {
            const int corner = j == 0 ? (i == 0 ? 0 : 1) : (i == 0 ? 3 : 2);
            return place(faces_(face, corner), face, i, j);
        }
        if (!on_column && !on_row) {
            const auto [entry, is_new] = interior_.try_emplace(j * side_ + i, num_vertices());
            return is_new ? append(face, i, j) : entry->second;
        }
        const int from = faces_(face, on_row ? (j == 0 ? 0 : 3) : (i == 0 ? 0 : 1));
        const int to = faces_(face, on_row ? (j == 0 ? 1 : 2) : (i == 0 ? 3 : 2));
        const int step = on_row ? i : j;
        const EdgeKey key{std::min(from, to), std::max(from, to), from < to ? step : side_ - step};
        const auto [entry, is_new] = edges_.try_emplace(key, num_vertices());
        return is_new ? append(face, i, j) : entry->second;
    }

    void next_face() { interior_.clear(); }
    const std::vector<int>& face_index() const { return face_index_; }  ///< -1: a vertex that no face uses
    const std::vector<Eigen::Vector2d>& st() const { return st_; }

private:
    using EdgeKey = std::array<int, 3>;

    int num_vertices() const { return static_cast<int>(st_.size()); }
    int append(int face, int i, int j) {
        face_index_.push_back(-1);
        st_.emplace_back();
        return place(num_vertices() - 1, face, i, j);
    }
    int place(int number, int face, int i, int j) {
        face_index_[number] = face;
        st_[number] = Eigen::Vector2d(i, j) / side_;
        return number;
    }

    QuadsIn faces_;
    int side_;
    std::vector<int> face_index_;
    std::vector<Eigen::Vector2d> st_;
    std::map<EdgeKey, int> edges_;
    std::map<int, int> interior_;  // of the present face
};

void check_levels(QuadsIn faces, int levels) {
    check_range("levels", levels, 0, SubdividedMesh::kMaxLevels);
    const Eigen::Index children = Eigen::Index{1} << (2 * levels);
    if (faces.rows() > std::numeric_limits<int>::max() / (4 * children)) {
        throw InvalidInput(std::to_string(faces.rows()) + " faces are too many for " +
                           std::to_string(levels) + " levels");
    }
}

}  // namespace

SubdividedMesh::SubdividedMesh(QuadsIn faces, int num_vertices, int levels) {
    check_faces(faces, num_vertices);
    check_levels(faces, levels);
    const int side = side_ = 1 << levels;
    faces_.resize(faces.rows() * side * side, 4);
    parent_.resize(faces_.rows());
    Grid grid(faces, num_vertices, side);
    int child = 0;
    for (int f = 0; f < faces.rows(); ++f) {
        grid.next_face();
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i, ++child) {
                faces_(child, 0) = grid.vertex(f, i, j);
                faces_(child, 1) = grid.vertex(f, i + 1, j);
                faces_(child, 2) = grid.vertex(f, i + 1, j + 1);
                faces_(child, 3) = grid.vertex(f, i, j + 1);
                parent_[child] = f;
            }
        }
    }
    const auto loose = std::find(grid.face_index().begin(), grid.face_index().end(), -1);
    if (loose != grid.face_index().end()) {
        throw InvalidInput("vertex " + std::to_string(loose - grid.face_index().begin()) +
                           " belongs to no face: drop it from the mesh");
    }
    Points2 st(grid.st().size(), 2);
    for (Eigen::Index i = 0; i < st.rows(); ++i) {
        st.row(i) = grid.st()[i];
    }
    limit_ = LimitSurface(faces, num_vertices,
                          Eigen::Map<const Eigen::VectorXi>(grid.face_index().data(), st.rows()), st);
}

SubdividedMesh::FacePlace SubdividedMesh::place_of(int triangle, const Eigen::Vector3d& weights) const {
    const auto num_faces = static_cast<int>(faces_.rows());
    check_range("triangle", triangle, 0, 2 * num_faces - 1);
    const Points2 corners{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int face = triangle % num_faces;
    const int child = face % (side_ * side_);
    Eigen::Vector2d place(child % side_, child / side_);
    for (int corner = 0; corner < 3; ++corner) {
        place += weights[corner] * corners
                                       .row(kQuadHalves[static_cast<std::size_t>(triangle / num_faces)]
                                                       [static_cast<std::size_t>(corner)])
                                       .transpose();
    }
    return {parent_[face], (place / side_).cwiseMax(0).cwiseMin(1)};
}

}  // namespace mimetic
