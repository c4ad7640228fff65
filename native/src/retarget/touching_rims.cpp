// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/retarget/touching_rims.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/surface/nearest.hpp>
#include <numeric>
#include <utility>

namespace mimetic {
namespace {

constexpr double kMoved = .5;          // of the longest offset: above it a vertex goes with the source
constexpr double kParted = .5;         // of the longest offset, by which the rims move against each other
constexpr double kShutReach = .35;     // of the longest offset: so near lie rims that touch
constexpr double kPartedReach = .125;  // the same of the jaw, which goes three times as far as a lid
constexpr double kWithIt = .5;         // of the longest offset: skin that a source moves goes further
constexpr double kShutWeight = 10;     // of lids, times the skin that goes with them
constexpr double kPartedWeight = 1;    // of lips, which shut one another in few frames; more costs smiles
constexpr double kPressed =
    .025;  // of the longest offset: lips that press are held a millimetre into each other
constexpr double kUnit = 1e-6;  // of a unit vector's length

/// A number for each vertex, the same for those that hang together.
std::vector<int> pieces(Eigen::Index count, const std::vector<int>& starts, const std::vector<int>& corners) {
    std::vector<int> parent(static_cast<std::size_t>(count));
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[static_cast<std::size_t>(v)] != v) {
            auto& up = parent[static_cast<std::size_t>(v)];
            up = parent[static_cast<std::size_t>(up)];
            v = up;
        }
        return v;
    };
    for (std::size_t face = 0; face < starts.size(); ++face) {
        const int begin = starts[face];
        const int end = face + 1 < starts.size() ? starts[face + 1] : static_cast<int>(corners.size());
        require(begin >= 0 && begin < end && end <= static_cast<int>(corners.size()),
                "each polygon of a mesh needs corners of its own");
        for (int c = begin; c < end; ++c) {
            const int vertex = corners[static_cast<std::size_t>(c)];
            require(vertex >= 0 && vertex < count, "a polygon of the mesh has a corner that is no vertex");
            parent[static_cast<std::size_t>(root(vertex))] = root(corners[static_cast<std::size_t>(begin)]);
        }
    }
    std::vector<int> piece(parent.size());
    for (std::size_t v = 0; v < piece.size(); ++v) {
        piece[v] = root(static_cast<int>(v));
    }
    return piece;
}

}  // namespace

void TiedVertices::check(Eigen::Index num_vertices) const {
    const Eigen::Index num_pairs = pairs.rows();
    require(ways.rows() == num_pairs && weights.size() == num_pairs && open.size() == num_pairs &&
                pressed.size() == num_pairs && rims.size() == num_pairs,
            "each pair of tied vertices needs a way, a weight, two lengths and the rims that it is of");
    require(num_pairs == 0 || (pairs.minCoeff() >= 0 && pairs.maxCoeff() < num_vertices),
            "a pair of tied vertices names one that the surface does not have");
    require(weights.allFinite() && (num_pairs == 0 || weights.minCoeff() >= 0),
            "weights of tied vertices must be finite and at least 0");
    require(open.allFinite() && pressed.allFinite() &&
                (num_pairs == 0 || (pressed.minCoeff() >= 0 && rims.minCoeff() >= 0)),
            "lengths of tied vertices must be finite, and rims be numbered from 0");
    require(ways.allFinite() && ((ways.rowwise().norm().array() - 1).abs() < kUnit).all(),
            "ways of tied vertices must be unit vectors");
}

TiedVertices touching_rims(PointsIn points, const std::vector<int>& starts, const std::vector<int>& corners,
                           VectorIn areas, PointsIn offsets, RimMotion motion) {
    require(points.rows() == offsets.rows() && points.rows() == areas.size() && points.allFinite() &&
                offsets.allFinite(),
            "rims need a finite point, an area and a finite offset for each vertex");
    const Eigen::VectorXd lengths = offsets.rowwise().norm();
    const double longest = points.rows() > 0 ? lengths.maxCoeff() : 0;
    if (longest == 0) {
        return {};
    }
    const std::vector<int> piece = pieces(points.rows(), starts, corners);
    const bool shuts = motion == RimMotion::shuts;
    const Points touching = shuts ? Points(points + offsets) : Points(points);
    std::vector<int> movers, others;
    for (int v = 0; v < static_cast<int>(points.rows()); ++v) {
        (lengths[v] > kMoved * longest ? movers : others).push_back(v);
    }
    if (others.empty()) {
        return {};
    }
    const Points cloud = touching(others, Eigen::all);
    const Points asked = touching(movers, Eigen::all);
    const Eigen::VectorXi nearest = NearestPoints(cloud).find(asked);
    const double reach = (shuts ? kShutReach : kPartedReach) * longest;
    std::vector<std::pair<int, int>> found;
    for (std::size_t i = 0; i < movers.size(); ++i) {
        const int mover = movers[i];
        const int other = others[static_cast<std::size_t>(nearest[static_cast<Eigen::Index>(i)])];
        const bool is_near = (touching.row(mover) - touching.row(other)).norm() < reach;
        const bool is_parted = (offsets.row(mover) - offsets.row(other)).norm() > kParted * longest;
        if (is_near && is_parted &&
            piece[static_cast<std::size_t>(mover)] == piece[static_cast<std::size_t>(other)]) {
            found.emplace_back(mover, other);
        }
    }
    const auto count = static_cast<Eigen::Index>(found.size());
    TiedVertices tied;
    tied.pairs.resize(count, 2);
    tied.ways.resize(count, 3);
    tied.open.resize(count);
    tied.pressed = Eigen::VectorXd::Constant(count, kPressed * longest);
    tied.rims = Eigen::VectorXi::Zero(count);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        tied.pairs.row(row) << found[i].first, found[i].second;
        const Eigen::RowVector3d moved = offsets.row(found[i].first) - offsets.row(found[i].second);
        tied.ways.row(row) = (shuts ? -1 : 1) * moved.normalized();
        tied.open[row] = shuts ? moved.norm() : 0;
    }
    const double skin = (lengths.array() > kWithIt * longest).select(areas, 0.).sum();
    const double whole = (shuts ? kShutWeight : kPartedWeight) * skin;
    tied.weights = Eigen::VectorXd::Constant(
        tied.pairs.rows(), whole / static_cast<double>(std::max<std::size_t>(1, found.size())));
    return tied;
}

TiedVertices joined(const std::vector<TiedVertices>& parts) {
    Eigen::Index count = 0;
    for (const TiedVertices& part : parts) {
        count += part.pairs.rows();
    }
    TiedVertices all;
    all.pairs.resize(count, 2);
    all.ways.resize(count, 3);
    all.weights.resize(count);
    all.open.resize(count);
    all.pressed.resize(count);
    all.rims.resize(count);
    Eigen::Index row = 0;
    int num_rims = 0;
    for (const TiedVertices& part : parts) {
        const Eigen::Index own = part.pairs.rows();
        if (own == 0) {
            continue;
        }
        all.pairs.middleRows(row, own) = part.pairs;
        all.ways.middleRows(row, own) = part.ways;
        all.weights.segment(row, own) = part.weights;
        all.open.segment(row, own) = part.open;
        all.pressed.segment(row, own) = part.pressed;
        all.rims.segment(row, own) = part.rims.array() + num_rims;
        num_rims += part.rims.maxCoeff() + 1;
        row += own;
    }
    return all;
}

}  // namespace mimetic
