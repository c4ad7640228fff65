// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/register/foreign_skin.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

#include "weld.hpp"

namespace mimetic {
namespace {

constexpr int kMaxSkinVertices = 200'000;
constexpr double kMaxOffSkin = .02;  // m, of a landmark given as a point, at the template's size
constexpr int kMaxAround = 256;      // triangles at a vertex

/// Row of `vertices` that is nearest to a place.
int nearest_to(const Eigen::RowVector3d& place, const Points& points, const std::vector<int>& rows) {
    return *std::min_element(rows.begin(), rows.end(), [&](int a, int b) {
        return (points.row(a) - place).squaredNorm() < (points.row(b) - place).squaredNorm();
    });
}

std::vector<int> used_vertices(const Triangles& triangles) {
    std::vector<int> used(triangles.data(), triangles.data() + triangles.size());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

/// The part of the mesh that most landmarks lie on. welded: places; rows: those that triangles use.
int skin_part(const NamedPlaces& landmarks, const Points& targets, const Points& welded,
              const std::vector<int>& rows, const std::vector<int>& part) {
    std::map<int, int> votes;
    for (Eigen::Index i = 0; i < targets.rows(); ++i) {
        ++votes[part[static_cast<std::size_t>(nearest_to(targets.row(i), welded, rows))]];
    }
    const int chosen = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                           return a.second < b.second;
                       })->first;
    std::vector<int> own;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(own),
                 [&](int v) { return part[static_cast<std::size_t>(v)] == chosen; });
    for (Eigen::Index i = 0; i < targets.rows(); ++i) {
        const int nearest = nearest_to(targets.row(i), welded, own);
        const double gap = (welded.row(nearest) - targets.row(i)).norm();
        if (gap > kMaxOffSkin) {
            throw InvalidInput("landmark " + landmarks.names[static_cast<std::size_t>(i)] + " lies " +
                               std::to_string(std::lround(1e3 * gap)) +
                               " mm (on a head of usual size) off the part that " +
                               "carries most landmarks: put it on the skin, and make the skin one piece");
        }
    }
    return chosen;
}

/// Triangles of one part that have three corners, and their faces.
CutFaces keep_part(const CutFaces& faces, const std::vector<int>& part, int chosen, int& num_collapsed) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index t = 0; t < faces.triangles.rows(); ++t) {
        const Eigen::RowVector3i corners = faces.triangles.row(t);
        if (part[static_cast<std::size_t>(corners[0])] != chosen) {
            continue;
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
            ++num_collapsed;
        } else {
            rows.push_back(t);
        }
    }
    return {faces.triangles(rows, Eigen::all), faces.face(rows)};
}

void check_size(const Triangles& triangles, const std::vector<int>& own, const Welded& welded) {
    if (own.size() > static_cast<std::size_t>(kMaxSkinVertices)) {
        throw InvalidInput("the skin has " + std::to_string(own.size()) + " vertices, at most " +
                           std::to_string(kMaxSkinVertices) +
                           " are taken: attach the muscles to a coarser copy of the mesh");
    }
    if (own.empty()) {
        throw InvalidInput("the part of the mesh that carries the landmarks has no faces with an extent");
    }
    Eigen::VectorXi around = Eigen::VectorXi::Zero(static_cast<Eigen::Index>(welded.kept.size()));
    for (const int corner : triangles.reshaped()) {
        ++around[corner];
    }
    Eigen::Index most = 0;
    if (around.maxCoeff(&most) > kMaxAround) {
        throw InvalidInput("more than " + std::to_string(kMaxAround) + " faces meet at vertex " +
                           std::to_string(welded.kept[static_cast<std::size_t>(most)]));
    }
}

void check_areas(const ForeignSkin& skin) {
    for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
        const Eigen::RowVector3d a = skin.vertices.row(skin.triangles(t, 0));
        const Eigen::RowVector3d ab = skin.vertices.row(skin.triangles(t, 1)) - a;
        const Eigen::RowVector3d ac = skin.vertices.row(skin.triangles(t, 2)) - a;
        const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ab - ac).squaredNorm()});
        if (!(ab.cross(ac).norm() > 1e-9 * longest)) {
            throw InvalidInput("face " + std::to_string(skin.face[t]) +
                               " has no area: remove it or merge its vertices");
        }
    }
}

/// The nose and the chin of a head look forwards.
void check_outward(const ForeignSkin& skin, const std::vector<int>& front) {
    const Points normals = vertex_normals(skin.vertices, skin.triangles);
    double forwards = 0;
    for (const int i : front) {
        Eigen::Index nearest = 0;
        (skin.vertices.rowwise() - skin.landmarks.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
        forwards += normals(nearest, 2);
    }
    if (forwards < 0) {
        throw InvalidInput("the faces look inwards: reverse the order of each face's vertices");
    }
}

}  // namespace

ForeignSkin read_foreign_skin(PointsIn points, const CutFaces& faces, const NamedPlaces& landmarks,
                              const Similarity& user_from_skin) {
    ForeignSkin skin;
    const Similarity skin_from_user = user_from_skin.inverse();
    skin.user_vertices = skin_from_user.apply(points);
    skin.landmarks = skin_from_user.apply(landmarks.places);
    const Welded welded = weld(skin.user_vertices);
    CutFaces cut = faces;
    for (int& corner : cut.triangles.reshaped()) {
        corner = welded.number[static_cast<std::size_t>(corner)];
    }
    const Points places = skin.user_vertices(welded.kept, Eigen::all);
    const std::vector<int> part = parts_of(cut.triangles, welded.kept.size());
    const int chosen = skin_part(landmarks, skin.landmarks, places, used_vertices(cut.triangles), part);
    cut = keep_part(cut, part, chosen, skin.num_collapsed);
    const std::vector<int> own = used_vertices(cut.triangles);
    check_size(cut.triangles, own, welded);
    std::vector<int> number(welded.kept.size(), -1);
    for (std::size_t i = 0; i < own.size(); ++i) {
        number[static_cast<std::size_t>(own[i])] = static_cast<int>(i);
    }
    for (int& corner : cut.triangles.reshaped()) {
        corner = number[static_cast<std::size_t>(corner)];
    }
    skin.vertices = places(own, Eigen::all);
    skin.triangles = cut.triangles;
    skin.face = cut.face;
    skin.skin_vertex.resize(points.rows());
    skin.loose.resize(points.rows());
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const auto place = static_cast<std::size_t>(welded.number[static_cast<std::size_t>(v)]);
        skin.skin_vertex[v] = number[place];
        skin.loose[v] = number[place] >= 0 ? -1 : part[place];
    }
    check_outward(skin, landmarks.front);
    check_areas(skin);
    return skin;
}

}  // namespace mimetic
