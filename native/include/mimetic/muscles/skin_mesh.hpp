// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/muscles/template_skin.hpp>
#include <mutex>

namespace mimetic {

/// Triangles 2i and 2i + 1 of quad i, cut along its shorter diagonal: a mirrored mesh is then cut in mirrored
/// places.
Triangles split_quads(PointsIn vertices, QuadsIn quads);

/// Unit normals of vertices (V x 3): of the quads around each, by their areas; 0 without any.
Points quad_normals(PointsIn vertices, QuadsIn quads);

/// A value that is computed when it is first read, thread-safe.
template <typename Value>
class Lazy {
public:
    template <typename Make>
    const Value& get(const Make& make) const {
        std::call_once(once_, [&] { value_ = std::make_unique<const Value>(make()); });
        return *value_;
    }

private:
    mutable std::once_flag once_;
    mutable std::unique_ptr<const Value> value_;
};

/// A neutral head's skin, refined and cut into triangles. V control vertices of the whole head, S of its skin
/// (they come first), N vertices of the refined skin, T triangles. Metres, head frame.
class SkinMesh {
public:
    /// neutral: V x 3, of the template's mesh. Inverted faces are smoothed (see `inverted_faces`).
    /// Throws InvalidInput on another number of vertices, NaN, and faces that stay inverted after
    /// smoothing.
    SkinMesh(std::shared_ptr<const TemplateSkin> shared, PointsIn neutral);

    const TemplateSkin& shared() const { return *shared_; }
    const TemplateMesh& head() const { return shared_->mesh(); }
    const Points& neutral() const { return neutral_; }                               ///< V x 3
    const SparseRows& stencils() const { return shared_->refinement().stencils(); }  ///< N x S
    const Points& vertices() const { return vertices_; }                             ///< N x 3
    const Triangles& triangles() const { return triangles_; }                        ///< T x 3
    const std::vector<bool>& outer() const { return outer_; }  ///< T, of the visible skin, not of linings
    const Points& normals() const { return normals_; }         ///< N x 3, unit
    /// Refined vertices of the visible skin that do not face backwards, rising.
    const std::vector<int>& seen_from_front() const { return seen_from_front_; }

    const std::vector<int>& inverted_faces() const { return inverted_; }  ///< of the head, that were smoothed
    double smoothed_by() const { return smoothed_by_; }                   ///< m, at most

    const MuscleSurface& surface() const;        ///< the visible skin, on which muscles act
    const MuscleSurface& whole_surface() const;  ///< with mouth cavity and eye sockets

    /// S: scale of this person's skin relative to the template's around each vertex. Square root of
    /// the areas' ratio, averaged with a Gaussian over the template.
    const Eigen::VectorXd& local_scale() const;
    double size() const { return size_; }  ///< scale of this head relative to the template

    int landmark(const std::string& name) const { return shared_->landmark(name); }
    Eigen::RowVector3d landmark_place(const std::string& name) const;  ///< of the neutral
    Points places(const std::vector<int>& control_vertices) const;     ///< on the refined skin
    Eigen::RowVector3d mean_landmark(const std::vector<std::string>& names) const;

private:
    std::shared_ptr<const TemplateSkin> shared_;
    Points neutral_;
    Points vertices_;
    Triangles triangles_;
    std::vector<bool> outer_;
    Points normals_;
    std::vector<int> seen_from_front_;
    std::vector<int> inverted_;
    double smoothed_by_ = 0;
    double size_ = 1;
    Lazy<MuscleSurface> surface_, whole_surface_;
    Lazy<Eigen::VectorXd> local_scale_;
};

/// A point fixed to a refined vertex, and so defined on every person.
struct Place {
    int vertex = 0;
    Eigen::RowVector3d offset =
        Eigen::RowVector3d::Zero();  ///< from the vertex, along the skin, m on the template
    double depth = 0;                ///< inwards from the skin, m on the template

    Eigen::RowVector3d position(const SkinMesh& mesh) const;
    double scale(const SkinMesh& mesh) const;  ///< of lengths here relative to the template
};

/// The place on the skin that lies x, y millimetres from a landmark as seen from the front, `depth` under it.
struct LandmarkPlace {
    std::string anchor;  ///< a landmark's name without .L and .R
    double x = 0;        ///< mm, away from the midline on the place's side
    double y = 0;        ///< mm, up
    double depth = 0;    ///< mm, inwards
};

/// canonical: the template's own skin; side: 'L' or 'R'. Throws InvalidInput on an unknown landmark.
Place find_place(const SkinMesh& canonical, const LandmarkPlace& at, char side);

}  // namespace mimetic
