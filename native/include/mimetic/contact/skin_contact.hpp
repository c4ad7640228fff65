// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/contact/contact.hpp>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/shared/progress.hpp>
#include <mimetic/skin/skin.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// Points of the skin that can touch.
struct TouchPoints {
    Points rest;          ///< C x 3, metres, head frame
    SparseRows stencils;  ///< C x B, what a point is of the skin's base vertices
    std::vector<Slit> slits;
};

/// Skin that slides on an eye: what would penetrate the eyeball is pushed back to its distance.
struct EyeRest {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<int> vertices;  ///< E base vertices
    Points rest;                ///< E x 3, their places at rest, metres
    Eigen::VectorXd share;      ///< E, share of the penetration that is undone, 1 at the lids' margin
    double sink = 0;            ///< m, of penetration that is tolerated

    Points push(PointsIn displacement) const;  ///< E x 3, away from the eye's centre
};

/// Lids on an eye. surface: of the whole skin; margin: K x 3, the edge of the lids; rest: S x 3, the control
/// vertices, first among the surface's; reach: metres along the skin where lids end; size: the head's, the
/// template's being 1.
EyeRest rest_on_eye(const MuscleSurface& surface, PointsIn margin, PointsIn rest,
                    const Eigen::Vector3d& centre, double reach, double size);

/// The deformable skin that contact acts on: B base vertices, V of the whole head.
struct YieldingSkin {
    const SkinModel& model;       ///< its unknowns are the free vertices
    std::vector<bool> free;       ///< of the model's S vertices; held ones do not move
    std::vector<int> moves_with;  ///< V, the base vertex that each vertex of the head goes with; -1: none
    std::vector<int> read;        ///< B, the vertex of the head that is each base vertex
    SparseRows carrier;           ///< B x S, how the model's vertices carry these; empty: they are the same
};

/// Frictionless contact between the lips and between the lids of a head, quasi-static.
///
/// Modes add up linearly and do not interact, so that lips that are pressed together would pass
/// through each other. The smallest contact forces that separate them solve a linear complementarity
/// problem on the skin's own compliance, condensed to the points that can touch. Displacements are in metres,
/// in the head frame, or in that of `turned`.
class SkinContact {
public:
    using Corrections = Rows<float, 3>;

    SkinContact(const TouchPoints& touch, const std::vector<EyeRest>& eyes, const YieldingSkin& skin);

    const std::vector<int>& vertices() const;  ///< K of the head that are tested
    const std::vector<int>& moved() const;     ///< W of the head that contact may displace
    int num_slits() const;

    /// Displacement of `moved` (W x 3) that separates lips and lids; empty if nothing overlaps. displacement:
    /// K x 3, of `vertices`.
    std::optional<Corrections> correction(PointsIn displacement) const;

    /// The displacement (V x 3) with lips and lids separated; unchanged where nothing overlaps.
    Points relieve(PointsIn displacement) const;

    /// Gaps of the overlaps at a displacement (V x 3), metres, all negative.
    Eigen::VectorXd gaps(PointsIn displacement) const;

    /// The same contact for displacements in another frame: linear * those of this.
    SkinContact turned(const Eigen::Matrix3d& linear) const;

private:
    struct Parts;

    Points at_vertices(PointsIn displacement) const;
    Points push(PointsIn displacement) const;
    Points yield(const Eigen::VectorXd& forces) const;

    std::shared_ptr<const Parts> parts_;
    Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
};

/// A part of a motion: N frames' values of M modes, and these at the contact's vertices.
struct MotionPart {
    MatrixRows values;  ///< N x M
    MatrixRows modes;   ///< M x 3K, metres
};

/// Few shapes whose sums are the corrections of a take, frame by frame.
struct ContactShapes {
    MatrixRows values;   ///< N x S, the largest of each shape is 1
    MatrixRows offsets;  ///< S x 3W, metres, of the vertices that contact moves
};

/// Principal shapes of C corrections (a row each, 3W metres), which are those of `frames` (C, from 0) of
/// num_frames; all other frames have the value 0. Raises InvalidInput.
ContactShapes shapes_of_corrections(const MatrixRows& corrections, const std::vector<Eigen::Index>& frames,
                                    Eigen::Index num_frames);

/// Corrections over time lie close to a few shapes; frames in which nothing touches have the value 0. Stopped
/// by `progress`, they cover the frames so far.
ContactShapes contact_shapes(const SkinContact& contact, const std::vector<MotionPart>& parts,
                             const Progress& progress);

}  // namespace mimetic
