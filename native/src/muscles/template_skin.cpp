// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/muscles/template_skin.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

int number_of(const std::vector<std::string>& names, const std::string& name, const char* what) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) {
        throw InvalidInput("the template has no " + std::string(what) + " '" + name + "'; it has " +
                           listed(names));
    }
    return static_cast<int>(at - names.begin());
}

void check_indices(const Eigen::Ref<const Eigen::ArrayXi>& values, Eigen::Index end, const char* name) {
    if (values.size() > 0 && (values.minCoeff() < 0 || values.maxCoeff() >= end)) {
        throw InvalidInput("the template's " + std::string(name) + " must lie in 0 to " +
                           std::to_string(end - 1));
    }
}

std::vector<bool> used_by(const TemplateMesh& mesh, int part, Eigen::Index num_faces) {
    std::vector<bool> used(mesh.vertices.rows(), false);
    for (Eigen::Index f = 0; f < num_faces; ++f) {
        for (int k = 0; k < 4 && mesh.part[f] == part; ++k) {
            used[mesh.faces(f, k)] = true;
        }
    }
    return used;
}

TemplateMesh checked(TemplateMesh mesh) {
    mesh.check();
    return mesh;
}

}  // namespace

void TemplateMesh::check() const {
    const Eigen::Index count = num_skin_vertices;
    const bool fits = count > 0 && count <= vertices.rows() && num_skin_faces > 0 &&
                      num_skin_faces <= faces.rows() && part.size() == faces.rows() &&
                      region.size() == count &&
                      landmark_vertices.size() == static_cast<Eigen::Index>(landmark_names.size()) &&
                      eye_centers.rows() == 2 && jaw_hinge.rows() == 2;
    if (!fits) {
        throw InvalidInput("the template's arrays do not fit each other");
    }
    const Eigen::Map<const Eigen::ArrayXi> corners(faces.data(), faces.size());
    check_indices(corners, vertices.rows(), "faces");
    check_indices(corners.head(4 * num_skin_faces), count, "skin faces");
    check_indices(part.array(), static_cast<Eigen::Index>(part_names.size()), "part");
    check_indices(region.array(), static_cast<Eigen::Index>(region_names.size()), "region");
    check_indices(landmark_vertices.array(), count, "landmark_vertices");
}

TemplateSkin::TemplateSkin(TemplateMesh mesh)
    : mesh_(checked(std::move(mesh))),
      refinement_(mesh_.faces.topRows(mesh_.num_skin_faces), mesh_.num_skin_vertices, kLevels) {
    const int skin = part_number("skin");
    std::vector<Eigen::Index> outer;
    for (Eigen::Index f = 0; f < mesh_.num_skin_faces; ++f) {
        if (mesh_.part[f] == skin) {
            outer.push_back(f);
        }
    }
    outer_quads_ = mesh_.faces(outer, Eigen::all);
}

bool TemplateSkin::has_landmark(const std::string& name) const {
    return std::find(mesh_.landmark_names.begin(), mesh_.landmark_names.end(), name) !=
           mesh_.landmark_names.end();
}

int TemplateSkin::landmark(const std::string& name) const {
    return mesh_.landmark_vertices[number_of(mesh_.landmark_names, name, "landmark")];
}

Flags TemplateSkin::in_region(const std::string& name) const {
    return mesh_.region.array() == number_of(mesh_.region_names, name, "region");
}

int TemplateSkin::part_number(const std::string& name) const {
    return number_of(mesh_.part_names, name, "part");
}

std::vector<int> TemplateSkin::part_vertices(const std::string& name) const {
    const std::vector<bool> used = used_by(mesh_, part_number(name), mesh_.faces.rows());
    std::vector<int> vertices;
    for (int v = 0; v < static_cast<int>(used.size()); ++v) {
        if (used[v]) {
            vertices.push_back(v);
        }
    }
    return vertices;
}

std::vector<int> TemplateSkin::vertices_between(const std::string& part, const std::string& other) const {
    const std::vector<bool> first = used_by(mesh_, part_number(part), mesh_.num_skin_faces);
    const std::vector<bool> second = used_by(mesh_, part_number(other), mesh_.num_skin_faces);
    std::vector<int> vertices;
    for (int v = 0; v < static_cast<int>(first.size()); ++v) {
        if (first[v] && second[v]) {
            vertices.push_back(v);
        }
    }
    return vertices;
}

}  // namespace mimetic
