// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/register/face_units.hpp>
#include <mimetic/shared/checks.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace mimetic {
namespace {

constexpr double kMeeting = 1e3;     // of the gap of the rims, against a second difference
constexpr double kRims = 10;         // of the places where they meet
constexpr double kEye = 300;         // of a place on the eye
constexpr double kHold = 1e-4;       // of a displacement: the correction is not larger than it must be
constexpr double kClearance = 1e-4;  // m above the eye
constexpr int kRounds = 6;           // of finding what lies inside the eye
constexpr double kShortest = 1e-5;   // m, of an edge in its weight

using Sparse = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<Sparse>;

/// Skin that a correction moves, and what it costs.
struct Patch {
    std::vector<Eigen::Index> free;  // vertices
    std::vector<int> number;         // N, their rows; -1
    std::vector<std::pair<int, int>> edges;
    Sparse cost;
};

Patch patch_of(const MuscleSurface& surface, const Eigen::VectorXd& way, double reach) {
    const Points& vertices = surface.vertices();
    Patch patch;
    patch.number.assign(static_cast<std::size_t>(vertices.rows()), -1);
    for (Eigen::Index v = 0; v < way.size(); ++v) {
        if (way[v] < reach) {
            patch.number[static_cast<std::size_t>(v)] = static_cast<int>(patch.free.size());
            patch.free.push_back(v);
        }
    }
    const auto is_free = [&](int v) { return patch.number[static_cast<std::size_t>(v)] >= 0; };
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < surface.triangles().rows(); ++t) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int a = surface.triangles()(t, k), b = surface.triangles()(t, (k + 1) % 3);
            if (is_free(a) || is_free(b)) {
                edges.emplace(std::min(a, b), std::max(a, b));
            }
        }
    }
    patch.edges.assign(edges.begin(), edges.end());
    // Second differences: a vertex against the mean of its neighbours, the near ones counting more
    std::vector<double> sums(static_cast<std::size_t>(vertices.rows()), 0);
    const auto weight = [&](int a, int b) {
        return 1 / std::max((vertices.row(a) - vertices.row(b)).norm(), kShortest);
    };
    for (const auto& [a, b] : patch.edges) {
        sums[static_cast<std::size_t>(a)] += weight(a, b);
        sums[static_cast<std::size_t>(b)] += weight(a, b);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [a, b] : patch.edges) {
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
            if (is_free(to)) {
                entries.emplace_back(from, patch.number[static_cast<std::size_t>(to)],
                                     -weight(a, b) / sums[static_cast<std::size_t>(from)]);
            }
        }
    }
    for (std::size_t row = 0; row < patch.free.size(); ++row) {
        entries.emplace_back(static_cast<int>(patch.free[row]), static_cast<int>(row), 1.);
    }
    const auto count = static_cast<Eigen::Index>(patch.free.size());
    Sparse differences(vertices.rows(), count), hold(count, count);
    differences.setFromTriplets(entries.begin(), entries.end());
    hold.setIdentity();
    patch.cost = Sparse(differences.transpose() * differences) + kHold * hold;
    return patch;
}

/// What is asked of the skin's motion.
class Wishes {
public:
    /// A place's move.
    void add(const Patch& patch, const Eigen::RowVector3i& corners, const Eigen::RowVector3d& weights,
             const Eigen::RowVector3d& move, double strength) {
        add_terms(patch, corners, weights, std::sqrt(strength));
        moves_.emplace_back(std::sqrt(strength) * move);
    }

    /// The move of a pair's upper place against its lower one.
    void add_meeting(const Patch& patch, const SlitPlaces& slit, Eigen::Index pair,
                     const Eigen::RowVector3d& move) {
        const double root = std::sqrt(kMeeting);
        add_terms(patch, slit.upper.corners.row(pair), slit.upper.weights.row(pair), root);
        add_terms(patch, slit.lower.corners.row(pair), slit.lower.weights.row(pair), -root);
        moves_.emplace_back(root * move);
    }

    /// The correction of the free skin, least in cost and nearest to what is asked for.
    Points solve(const Patch& patch) const {
        const auto count = static_cast<Eigen::Index>(moves_.size());
        Sparse rows(count, patch.cost.cols());
        rows.setFromTriplets(entries_.begin(), entries_.end());
        Points wanted(count, 3);
        for (Eigen::Index i = 0; i < count; ++i) {
            wanted.row(i) = moves_[static_cast<std::size_t>(i)];
        }
        const Sparse system = patch.cost + Sparse(rows.transpose() * rows);
        const Solver solver(system);
        return solver.solve(Eigen::MatrixXd(rows.transpose() * wanted));
    }

private:
    void add_terms(const Patch& patch, const Eigen::RowVector3i& corners, const Eigen::RowVector3d& weights,
                   double factor) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            const int at = patch.number[static_cast<std::size_t>(corners[k])];
            if (at >= 0 && weights[k] != 0) {
                entries_.emplace_back(static_cast<int>(moves_.size()), at, factor * weights[k]);
            }
        }
    }

    std::vector<Eigen::Triplet<double>> entries_;
    std::vector<Eigen::RowVector3d> moves_;
};

/// Vertices and middles of edges that lie outside of an eye at rest, and which of them must be lifted.
class OutsideSkin {
public:
    OutsideSkin(const Patch& patch, const Points& rest, const EyeSurface& eye) : eye_(eye) {
        if (!eye.is_there()) {
            return;
        }
        std::vector<std::pair<int, int>> places = patch.edges;
        for (const Eigen::Index v : patch.free) {
            places.emplace_back(static_cast<int>(v), static_cast<int>(v));
        }
        places_ = places;
        const Eigen::VectorXd depths = eye.depths(at(rest));
        std::vector<std::pair<int, int>> outside;
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (depths[static_cast<Eigen::Index>(i)] < 0) {
                outside.push_back(places[i]);
            }
        }
        places_ = std::move(outside);
        is_lifted_.assign(places_.size(), false);
    }

    /// Whether more lies inside than before; it is lifted from now on.
    bool find_inside(const Points& shape) {
        if (places_.empty()) {
            return false;
        }
        const Eigen::VectorXd depths = eye_.depths(at(shape));
        bool is_more = false;
        for (std::size_t i = 0; i < places_.size(); ++i) {
            if (depths[static_cast<Eigen::Index>(i)] > -kClearance / 2 && !is_lifted_[i]) {
                is_lifted_[i] = is_more = true;
            }
        }
        return is_more;
    }

    void wish(const Patch& patch, const Points& shape, Wishes& wishes, const Points& now) const {
        if (places_.empty()) {
            return;
        }
        const Points from = at(shape), to = eye_.lifted(at(now), kClearance);
        for (std::size_t i = 0; i < places_.size(); ++i) {
            if (is_lifted_[i]) {
                const auto [a, b] = places_[i];
                const auto row = static_cast<Eigen::Index>(i);
                wishes.add(patch, {a, b, b}, {.5, .5, 0}, to.row(row) - from.row(row), kEye);
            }
        }
    }

private:
    Points at(const Points& shape) const {
        Points points(places_.size(), 3);
        for (std::size_t i = 0; i < places_.size(); ++i) {
            points.row(static_cast<Eigen::Index>(i)) =
                (shape.row(places_[i].first) + shape.row(places_[i].second)) / 2;
        }
        return points;
    }

    const EyeSurface& eye_;
    std::vector<std::pair<int, int>> places_;
    std::vector<bool> is_lifted_;
};

}  // namespace

void SlitOptions::check() const {
    check_range("SlitOptions.upper_share", upper_share, 0, 1);
    check_range("SlitOptions.reach", reach, 1e-4, 1);
}

Points close_slit(const MuscleSurface& surface, PointsIn displacement, const SlitPlaces& slit,
                  const SlitOptions& options, const EyeSurface& eye) {
    options.check();
    const Points& vertices = surface.vertices();
    const Eigen::Index count = slit.upper.corners.rows();
    require(displacement.rows() == vertices.rows() && count == slit.lower.corners.rows(),
            "a slit needs displacements of its whole skin, and pairs of places");
    if (count == 0) {
        return displacement;
    }
    const Points top = slit.upper.values(vertices), bottom = slit.lower.values(vertices);
    Points rims(2 * count, 3);
    rims << top, bottom;
    const Patch patch = patch_of(surface, surface.distances(rims, options.reach), options.reach);
    const Points rest_gap = options.keeps_gap ? Points(top - bottom) : Points::Zero(count, 3);
    const Points start = vertices + displacement;
    const Points upper = slit.upper.values(start), lower = slit.lower.values(start);
    const Points excess = upper - lower - rest_gap;
    const Points to_upper = eye.lifted(upper - options.upper_share * excess, kClearance),
                 to_lower = eye.lifted(lower + (1 - options.upper_share) * excess, kClearance);
    OutsideSkin outside(patch, vertices, eye);
    Points shape = start;
    for (int round = 0; round < kRounds; ++round) {
        Wishes wishes;
        for (Eigen::Index k = 0; k < count; ++k) {
            wishes.add_meeting(patch, slit, k,
                               to_upper.row(k) - upper.row(k) - to_lower.row(k) + lower.row(k));
            wishes.add(patch, slit.upper.corners.row(k), slit.upper.weights.row(k),
                       to_upper.row(k) - upper.row(k), kRims);
            wishes.add(patch, slit.lower.corners.row(k), slit.lower.weights.row(k),
                       to_lower.row(k) - lower.row(k), kRims);
        }
        outside.wish(patch, start, wishes, shape);
        const Points moves = wishes.solve(patch);
        shape = start;
        for (std::size_t row = 0; row < patch.free.size(); ++row) {
            shape.row(patch.free[row]) += moves.row(static_cast<Eigen::Index>(row));
        }
        if (!outside.find_inside(shape)) {
            break;
        }
    }
    return shape - vertices;
}

Eigen::VectorXd rim_gaps(PointsIn vertices, PointsIn displacement, const SlitPlaces& slit) {
    require(displacement.rows() == vertices.rows() && slit.upper.corners.rows() == slit.lower.corners.rows(),
            "each vertex needs a displacement, and each place of one rim one of the other");
    const Points moved = vertices + displacement;
    return (slit.upper.values(moved) - slit.lower.values(moved)).rowwise().norm();
}

}  // namespace mimetic
