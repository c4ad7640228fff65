// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "key_view.hpp"

namespace mimetic::head {

/// How a model differs from what it was: three logarithms of growth along its axes, a turn (rad) about its
/// centre, and a shift (metres); model axes, the head frame stays.
constexpr int kShapeSize = 9;
using ShapeChange = Eigen::Matrix<double, kShapeSize, 1>;

HeadShape changed(const HeadShape& shape, const ShapeChange& change);

/// Reference textures and the correspondences between them. Their poses and the model's shape are solved
/// jointly (bundle adjustment), so that errors do not accumulate from texture to texture.
class ViewGraph {
public:
    ViewGraph(const HeadShape& shape, const HeadOptions& options)
        : options_(options), model_{shape, shape.depth_error} {}

    /// The first texture keeps its pose.
    void add(const HeadCrop& crop, const Eigen::Isometry3d& camera_from_head, const Matrix6& covariance);

    /// Drops all but the first `count` textures, and what the others did to the shape.
    void keep(std::size_t count);

    /// Poses and shape from the correspondences; `anew`: which are measured again first. False: there are
    /// none.
    bool relax(bool anew);

    /// Poses of the textures on the head's own surface; those on the model stay. Empty: no correspondences.
    std::vector<PlacedView> place_on(const HeadShape& skin);

    /// Moves the textures and shapes the model so that it agrees.
    void move_views(const std::vector<Eigen::Isometry3d>& poses);

    const std::vector<KeyView>& views() const { return model_.views; }
    const HeadShape& shape() const { return model_.shape; }

private:
    struct Match {
        int x, y;                     // pixel of the first view
        Eigen::Vector2d pixel;        // of the second view
        Eigen::Matrix2d information;  // inverse covariance, times how independent it is
    };
    struct Pair {
        std::size_t from, to;
        std::vector<Match> matches;
    };
    struct Normal;
    enum class Free { all, poses, shape };
    /// A model of the head, and the textures on it.
    struct Body {
        HeadShape shape;
        double start_error = 0;
        std::vector<KeyView> views = {};
        ShapeChange change = ShapeChange::Zero();  // since the start
    };

    void match(const Body& body, std::size_t from, std::size_t to);
    void match_anew(const Body& body);
    Normal normal_equations(const Body& body, Free free) const;
    void add_pair(const Body& body, const Pair& pair, Normal& normal) const;
    double scale_of(const Body& body, const Pair& pair) const;
    double depth_error(const Body& body) const;
    void step(Body& body, Free free);

    HeadOptions options_;
    Body model_;
    std::vector<Pair> pairs_;
};

}  // namespace mimetic::head
