// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/contact/slits.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

constexpr double kLipDepth = .008;    // along the skin from the edge where lips can touch, m on the template
constexpr double kHalfLip = .040;     // along the skin from the middle of a lip to its corners
constexpr double kCornerGap = .0015;  // next to the corners of the eye lids are one skin

enum class Lip { none, upper, lower };

std::vector<int> kept_rim(const std::vector<int>& rim, const std::vector<bool>& kept) {
    std::vector<int> result;
    std::copy_if(rim.begin(), rim.end(), std::back_inserter(result),
                 [&](int vertex) { return kept[static_cast<std::size_t>(vertex)]; });
    return result;
}

void check_slit(const Slit& slit, Eigen::Index num_vertices) {
    check_vertices(slit.upper, num_vertices);
    check_vertices(slit.lower, num_vertices);
    check_corners(slit.triangles, num_vertices);
}

Triangles triangles_of(const std::vector<Eigen::RowVector3i>& rows) {
    Triangles triangles(rows.size(), 3);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        triangles.row(static_cast<Eigen::Index>(i)) = rows[i];
    }
    return triangles;
}

}  // namespace

Slit lip_slit(PointsIn vertices, TrianglesIn triangles, const MuscleSurface& surface, PointsIn margin,
              PointsIn inner, double size) {
    check_corners(triangles, vertices.rows());
    require(surface.vertices().rows() == vertices.rows() && inner.rows() == 2,
            "a slit of the lips needs the surface of its vertices, and the middles of both lips");
    const Eigen::VectorXd depth = surface.distances(margin, kLipDepth * size);
    const Eigen::VectorXd to_upper = surface.distances(inner.row(0), kHalfLip * size);
    const Eigen::VectorXd to_lower = surface.distances(inner.row(1), kHalfLip * size);
    std::vector<Lip> lip(static_cast<std::size_t>(vertices.rows()), Lip::none);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        if (std::isfinite(depth[v]) && to_upper[v] != to_lower[v]) {
            lip[static_cast<std::size_t>(v)] = to_upper[v] < to_lower[v] ? Lip::upper : Lip::lower;
        }
    }
    const auto lip_of = [&](int vertex) { return lip[static_cast<std::size_t>(vertex)]; };
    std::vector<bool> is_used(lip.size(), false);
    std::vector<Eigen::RowVector3i> own;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Eigen::RowVector3i corners = triangles.row(t);
        const Lip first = lip_of(corners[0]);
        if (first != Lip::none && lip_of(corners[1]) == first && lip_of(corners[2]) == first) {
            own.push_back(corners);
            for (const int vertex : corners) {
                is_used[static_cast<std::size_t>(vertex)] = true;
            }
        }
    }
    Slit slit{{}, {}, triangles_of(own)};
    for (int vertex = 0; vertex < static_cast<int>(lip.size()); ++vertex) {
        if (is_used[static_cast<std::size_t>(vertex)]) {
            (lip_of(vertex) == Lip::upper ? slit.upper : slit.lower).push_back(vertex);
        }
    }
    return slit;
}

Slit lid_slit(PointsIn vertices, const std::vector<int>& margin, PointsIn corners, double size) {
    check_vertices(margin, vertices.rows());
    require(corners.rows() == 2, "a slit of the lids has two corners");
    const double inner = std::abs(corners(0, 0)), outer = std::abs(corners(1, 0));
    Slit slit{{}, {}, Triangles(0, 3)};
    for (const int vertex : margin) {
        const double x = vertices(vertex, 0);
        const double along = std::clamp((std::abs(x) - inner) / (outer - inner), 0., 1.);
        const double chord = corners(0, 1) + along * (corners(1, 1) - corners(0, 1));
        if (std::min(std::abs(x - corners(0, 0)), std::abs(x - corners(1, 0))) > kCornerGap * size) {
            (vertices(vertex, 1) > chord ? slit.upper : slit.lower).push_back(vertex);
        }
    }
    return slit;
}

std::pair<std::vector<int>, std::vector<Slit>> number_slits(const std::vector<Slit>& slits,
                                                            const std::vector<bool>& kept) {
    for (const Slit& slit : slits) {
        check_slit(slit, static_cast<Eigen::Index>(kept.size()));
    }
    std::vector<int> vertices, number(kept.size(), -1);
    std::vector<Slit> own;
    for (const Slit& slit : slits) {
        own.push_back({kept_rim(slit.upper, kept), kept_rim(slit.lower, kept), Triangles(0, 3)});
        for (const std::vector<int>* rim : {&own.back().upper, &own.back().lower}) {
            vertices.insert(vertices.end(), rim->begin(), rim->end());
        }
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        number[static_cast<std::size_t>(vertices[i])] = static_cast<int>(i);
    }
    std::vector<Slit> numbered;
    for (std::size_t s = 0; s < slits.size(); ++s) {
        std::vector<Eigen::RowVector3i> rows;
        for (Eigen::Index t = 0; t < slits[s].triangles.rows(); ++t) {
            Eigen::RowVector3i corners = slits[s].triangles.row(t);
            for (int& corner : corners) {
                corner = number[static_cast<std::size_t>(corner)];
            }
            if (corners.minCoeff() >= 0) {
                rows.push_back(corners);
            }
        }
        Slit slit{own[s].upper, own[s].lower, triangles_of(rows)};
        for (std::vector<int>* rim : {&slit.upper, &slit.lower}) {
            for (int& vertex : *rim) {
                vertex = number[static_cast<std::size_t>(vertex)];
            }
        }
        const bool is_left = rows.empty() == (slits[s].triangles.rows() == 0);
        if (!slit.upper.empty() && !slit.lower.empty() && is_left) {
            numbered.push_back(std::move(slit));
        }
    }
    return {vertices, numbered};
}

}  // namespace mimetic
