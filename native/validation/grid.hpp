// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <mimetic/skin/shell.hpp>
#include <mimetic/skin/skin.hpp>
#include <vector>

namespace mimetic::validation {

/// Quads of a parameter square, each cut along its shorter diagonal.
struct Grid {
    int columns = 0;  ///< quads along s
    int rows = 0;     ///< quads along t
    Points vertices;
    Triangles triangles;

    int at(int column, int row) const { return row * (columns + 1) + column; }
    int num_vertices() const { return static_cast<int>(vertices.rows()); }
    bool on_edge(int vertex) const;
};

using Place = std::function<Eigen::Vector3d(double s, double t)>;

/// place: from the unit square to space.
Grid make_grid(int columns, int rows, const Place& place);

/// Moves inner vertices by up to `amount` of a quad's side, the same way every time.
void jitter(Grid& grid, double amount);

/// A third of the triangles around each vertex, m^2.
Eigen::VectorXd vertex_areas(PointsIn vertices, TrianglesIn triangles);

/// The same material everywhere, without attachment.
SkinMaterials even_skin(Eigen::Index count, double young, double poisson, double thickness);

/// Identity without the columns of held vertices.
SparseRows free_basis(const std::vector<bool>& held);

/// Columns of `free_basis` by vertex, -1 where held.
std::vector<int> free_columns(const std::vector<bool>& held);

/// Flags of a ShellModel's unknowns, by vertex and axis (0 to 2 displacement, 3 to 5 rotation).
class HeldUnknowns {
public:
    explicit HeldUnknowns(int num_vertices) : flags_(6 * num_vertices, false) {}
    void hold(int vertex, std::initializer_list<int> axes) {
        for (int axis : axes) {
            flags_[6 * vertex + axis] = true;
        }
    }
    const std::vector<bool>& flags() const { return flags_; }

private:
    std::vector<bool> flags_;
};

/// Values of all unknowns when some are prescribed and nothing loads the others.
Eigen::VectorXd solve_prescribed(const Eigen::MatrixXd& stiffness, const std::vector<bool>& prescribed,
                                 const Eigen::VectorXd& values);

}  // namespace mimetic::validation
