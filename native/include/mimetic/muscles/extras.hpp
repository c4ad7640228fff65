// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/attach.hpp>

namespace mimetic {

/// Extras: modes for animating by hand, beyond muscles, jaw and lids.
enum class ExtraType {
    push,     ///< forwards, and to the line between the lips
    roll,     ///< a couple about a line: at value 1 the lip turns out
    pressure  ///< along the skin's normal
};

/// An entry of data/extras.toml that loads the skin; a paired one stands for two.
struct ExtraEntry {
    std::string name;
    ExtraType type = ExtraType::push;
    bool paired = false;
    bool upper = false;  ///< roll: of the upper lip
    std::vector<LandmarkPlace> line;
    double forwards = 0;  ///< push: components of one force
    double inwards = 0;
    double width = 6;           ///< mm on the template, s.d. across the line
    LandmarkPlace measured_at;  ///< the place whose motion sets the strength
    double excursion = 0;       ///< mm on the template, its motion at value 1
};

/// One of them on a head.
struct PlacedExtra {
    ExtraEntry entry;
    Points line;       ///< K x 3 on the skin, metres
    double width = 0;  ///< metres on this head, likewise the excursion
    Place measured;
    double excursion = 0;
};

/// On a head of the template's mesh; left and right of a paired entry in turn. canonical: the template's own
/// skin.
std::vector<PlacedExtra> place_extras(const SkinMesh& canonical, const SkinMesh& mesh,
                                      const std::vector<ExtraEntry>& table);

/// The mouth's position and size, for extras.
struct MouthFrame {
    Eigen::RowVector3d slit = Eigen::RowVector3d::Zero();  ///< the middle between the lips, m
    double size = 1;                                       ///< times as long as the template
};

MouthFrame mouth_frame(const SkinMesh& mesh);

/// Nodal forces, N x 3, of one extra at some strength. surface: the skin that they act on.
Points extra_forces(const MuscleSurface& surface, const MouthFrame& mouth, const PlacedExtra& extra);

/// Responses of the skin at value 1, E x 3S, each with the strength that gives its excursion. measured: E x
/// S, rows that read the motion of each measured place. Throws InvalidInput, naming it, on a place that does
/// not move.
MatrixRows extra_responses(const AttachedSkin& skin, const MuscleSurface& surface, const MouthFrame& mouth,
                           const std::vector<PlacedExtra>& extras, const SparseRows& measured);

/// An eyeball that turns about its centre: axis of the left eye (the right eye's is mirrored), radians.
struct Gaze {
    Eigen::RowVector3d axis = Eigen::RowVector3d(1, 0, 0);
    double angle = 0;
};

/// Displacement of points (K x 3) of an eyeball turned by its whole angle.
Points turned_eye(const EyeFrame& frame, const Gaze& gaze, PointsIn points);

/// How far the skin about an eye turns with the lids as the eye looks up or down, S radians.
Eigen::VectorXd lid_angle(const EyeLids& lids, const Gaze& gaze);

}  // namespace mimetic
