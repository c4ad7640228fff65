// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/locate/locate.hpp>

namespace mimetic {

/// Eyes and mouth as the networks measure them, with their standard deviations on real faces: the corners of
/// eyes and mouth and the irises' centres (`pupil.L`, ...) as features, the lids' margins and the lips' edges
/// as curves named after the landmarks on them (`lid_upper.L`, `lip_lower_inner`, ...). mesh: with refined
/// eyes, which give the corners; eyes: the left first.
FaceFeatures network_features(const MeshPoints& mesh, const std::array<EyePoints, 2>& eyes);

/// Lids and irises alone, as a regressor measures them. eyes: the left first; presence: 0 to 1, of a face.
/// Throws InvalidInput.
FaceFeatures eye_features(const std::array<EyePoints, 2>& eyes, double presence);

/// Landmarks and the networks' features merged for a fit: where both have one, the networks' is taken, except
/// for the pupils, which stand for the eyeballs' centres and are combined with the irises. Where
/// they saw a mouth, the landmarks' lines of it are left out. Landmarks alone where the networks' eyes are
/// elsewhere: they saw something else.
FaceFeatures with_network_features(const FaceFeatures& landmarks, const FaceFeatures& seen);

/// What the networks saw, of features merged so, with errors for a head whose lids and lips move by
/// themselves: there lines pull on nothing else, so that they count as far as they can be believed, to the
/// corners. Pupils, corners and lines; no lines where the networks saw nothing. frames: that are fitted
/// together. The networks err alike in them: all together count as one. Throws InvalidInput without pupils.
FaceFeatures local_features(const FaceFeatures& joined, int frames);

/// How far each eye is open, the left first: between the middles of its lids' margins, of the upper one's
/// length. NaN of an eye that the networks did not see.
Eigen::Vector2d eye_openings(const FaceFeatures& seen);

}  // namespace mimetic
