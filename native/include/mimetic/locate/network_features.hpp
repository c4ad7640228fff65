// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/locate/locate.hpp>

namespace mimetic {

/// Eyes and mouth as the networks see them, with what they usually err by on real faces: the corners of eyes
/// and mouth and the irises' centres (`pupil.L`, ...) as features, the lids' margins and the lips' edges as
/// curves named after the landmarks on them (`lid_upper.L`, `lip_lower_inner`, ...).
/// mesh: with refined eyes, whose corners are its; eyes: the left first.
FaceFeatures network_features(const MeshPoints& mesh, const std::array<EyePoints, 2>& eyes);

/// Landmarks and what the networks see, as a fit takes them: what both have is the networks', but for the
/// pupils, which are the eyeballs' centres and to which an iris is a hint. Without the landmarks' lines of
/// the mouth. Landmarks alone where the networks look at something else: their eyes are elsewhere.
FaceFeatures with_network_features(const FaceFeatures& landmarks, const FaceFeatures& seen);

}  // namespace mimetic
