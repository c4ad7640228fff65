// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/retarget/bounded_fit.hpp>
#include <mimetic/retarget/touching_rims.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

struct ControlFitOptions {
    double sparsity = .002;  ///< of a control's own value, 0 to 1: what a control that is used has to save
    double ridge = .003;     ///< of a control's own response, 0 to 10: the pull to the value expected of it
    /// How much of a control's motion that sources cannot make counts, 1e-12 to 1. 1: the nearest surface.
    /// Near 0: what sources can make of a control stands for it, so that a control is played fully where the
    /// capture sees it in full, though its surface goes further than muscles do. Controls of which they can
    /// make little count by what they do, at any value.
    double unmatched_motion = 1e-5;
    /// Share of a source's motion, 0 to 1. A source of which the controls make less does not count in the fit
    /// of frames: a jaw that no control opens would hold back a smile that one makes.
    double least_explained = .1;
    /// How much values of the sources count by themselves, of their own responses, 0 to 10: muscles that move
    /// nearly the same skin, or that hold each other, are told apart by it.
    double value_match = .2;
    /// What tied rims weigh as controls are read, times their weights, 0 to 10: a capture sees lips part,
    /// though the skin that does is small.
    double tied_reading = .03;
    /// What tied rims that sources hold shut weigh in the fit of frames, times their weights, 0 to 1000,
    /// where the controls part them. What controls themselves do counts here, no reading of it.
    double hold_shut = 10;
    /// Rims count as parted where the controls part them by so many times what sources do at their widest
    /// place, 0 to 1000: keys may part lips by what no muscle does. 0: no place further than sources have it.
    double hold_slack = 20;
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// Values of one's own S sources as values of a character's own K controls, over one surface of V vertices.
///
/// Sources are muscles, jaw, lids and gaze; controls are shape keys, or bones by what the mesh does when they
/// move. Both displace in proportion to their values.
class ControlFit {
public:
    /// controls: K x 3V, sources: S x 3V, metres at value 1, rows of x, y, z of each vertex; weights: V, at
    /// least 0, of the vertices, their areas as a rule; *_range: lowest and highest values, K x 2, S x 2,
    /// around 0; tied: what is fitted besides, though it is no part of what is explained. Throws
    /// InvalidInput.
    ControlFit(MatrixIn controls, MatrixIn sources, VectorIn weights, MatrixIn control_range,
               MatrixIn source_range, const ControlFitOptions& options = {}, const TiedVertices& tied = {});

    /// Values of the sources, within their ranges, that do most nearly what each control does: K x S.
    const MatrixRows& readings() const { return readings_; }

    /// What share of each control's own motion those values make at the size that is best for it, 0 to 1: K;
    /// 0 for one that moves nothing.
    const Eigen::VectorXd& readable() const { return readable_; }

    /// The best values of the controls, row by row: T x K. values: T x S; expected: T x K, what each is
    /// pulled to, 0 where nothing is known. Sources below `least_explained` count as 0. Throws InvalidInput.
    MatrixRows frames(MatrixIn values, MatrixIn expected) const;

    /// Each source at its highest, and then at its lowest, as values of the controls, divided by that height:
    /// 2 S x K; 0 where a source does not go that way.
    MatrixRows mapping() const;

    /// What share of the motion of all rows the controls make, at most 1. values: T x S; fitted: T x K.
    double explained(MatrixIn values, MatrixIn fitted) const;

    /// What share of each source's motion its better row of the mapping makes at the size that is best for
    /// it, 0 to 1: S; 1 for one that moves nothing. Low where the character has no control that does the
    /// like.
    const Eigen::VectorXd& source_explained() const { return source_explained_; }

private:
    BoundedProblem problem() const;  ///< but for `linear`, which each row of values has its own of
    void read();
    void tie();
    void weigh_sources();
    Eigen::VectorXd most_apart(VectorIn values) const;
    Eigen::VectorXd held_shut(const BoundedProblem& problem, const Eigen::VectorXd& fitted,
                              VectorIn most) const;

    ControlFitOptions options_;
    TiedVertices tied_;
    Eigen::MatrixXd of_sources_;   // S x S, dot products of displacements
    Eigen::MatrixXd of_controls_;  // K x K
    Eigen::MatrixXd of_both_;      // K x S
    Eigen::MatrixXd hessian_;      // K x K, without ridge
    Eigen::MatrixXd slopes_;       // K x S
    Eigen::VectorXd scale_;        // K, the diagonal
    Eigen::VectorXd whole_;        // K, how much a control stands for all of its motion, not for its reading
    MatrixRows control_range_, source_range_;
    Eigen::MatrixXd parted_;      // K x P, how far the controls move tied vertices apart, along their ways
    Eigen::MatrixXd left_apart_;  // S x P, the sources
    MatrixRows readings_;
    Eigen::VectorXd readable_;
    Eigen::VectorXd source_explained_;
};

}  // namespace mimetic
