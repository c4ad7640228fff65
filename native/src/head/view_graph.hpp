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

/// Reference textures and where skin of one lies in another. Their poses and the model's shape are solved
/// together from all of that, so that errors do not add up from texture to texture.
class ViewGraph {
public:
    ViewGraph(const HeadShape& shape, const HeadOptions& options)
        : options_(options), shape_(shape), start_error_(shape.depth_error) {}

    /// The first texture stays where it is said to be.
    void add(const HeadCrop& crop, const Eigen::Isometry3d& camera_from_head, const Matrix6& covariance);

    /// Poses and shape from the correspondences; `anew`: which are measured again first. False: there are
    /// none.
    bool relax(bool anew);

    const std::vector<KeyView>& views() const { return views_; }
    const HeadShape& shape() const { return shape_; }

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

    void match(std::size_t from, std::size_t to);
    Normal normal_equations(bool is_rigid) const;
    void add_pair(const Pair& pair, double scale, Normal& normal) const;
    double scale_of(const Pair& pair) const;
    double depth_error() const;
    void step(bool is_rigid);

    HeadOptions options_;
    HeadShape shape_;
    double start_error_;
    ShapeChange change_ = ShapeChange::Zero();  // since the start
    std::vector<KeyView> views_;
    std::vector<Pair> pairs_;
};

}  // namespace mimetic::head
