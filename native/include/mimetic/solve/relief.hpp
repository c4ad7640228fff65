// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/progress.hpp>
#include <mimetic/solve/sightings.hpp>

namespace mimetic {

/// How the depth of a fitted head may change, and what moves its skin.
struct ReliefModel {
    MatrixRows components;  ///< C x 3S, metres at a standard deviation of the prior
    MatrixRows bumps;       ///< K x S, K may be 0: heights of smooth bumps, metres at a standard deviation,
                            ///< along the fitted frame's rays: what no component has
    MatrixRows modes;       ///< M x 3S, metres at the value 1: muscles and articulators that were followed
    Eigen::VectorXd std;    ///< M, priors
    std::vector<int> landmarks;  ///< control vertices of the landmarks of the fitted frame
    std::vector<int> spread;     ///< control vertices well spread over the face
    std::vector<int> judged;     ///< control vertices whose depth's s.d. is asked for
    Eigen::VectorXd start;       ///< C + K or empty: what the skin has of components and bumps already
};

/// Lengths in pupil distances are s.d. that keep the shape in place in the fitted frame's picture.
struct ReliefOptions {
    double model_error = .5e-3;   ///< metres: motion of the skin that no mode explains
    double landmark_held = .01;   ///< pupil distances
    double point_held = .02;      ///< pupil distances, of points spread over the face
    double depth_held = 1e-3;     ///< metres, of the whole face: nearer and smaller looks the same
    double lasting_error = 1e-3;  ///< metres: noise of the reference texture shifts a place in all frames
    double outline_error =
        2e-3;  ///< metres: by which the fitted frame shows a place of the outline elsewhere
    double alike = .02617993877991494;  ///< rad, 1.5 degrees: heads turned no more than about that show the
                                        ///< same errors again
    double least_cosine = .5;           ///< of ray and normal: at less, a change counts as at this cosine
    double grazing = .6;  ///< cosine of ray and normal, in either frame: a point seen at less tells less, by
                          ///< the fourth power, as its texture is of few pixels and an outline is near
};

struct Relief {
    Eigen::VectorXd coefficients;  ///< C + K: of components, then bumps; `start` included
    Eigen::VectorXd
        depth_std;  ///< one a `judged` vertex, metres: of its depth beside the mean of all `spread`
};

/// Depth of a face from frames in which the head is turned differently; coefficients are those of the whole
/// difference from the head without relief.
///
/// The fit to landmarks leaves depth to the prior. Between frames, a point that lies a
/// millimetre nearer moves further as the head turns. The texture of the reference frame keeps its rays:
/// where the shape moves, its points slide along them, so that only the component of a change normal to the
/// surface counts. Every frame's pose and modes are solved along with the shape and eliminated (bundle
/// adjustment with a prior [Triggs et al. 2000], one linear step: follow the head again with what it gives
/// for the next), and so is the common bias of the skin's points over all frames: only what changes with the
/// rotation is depth.
/// No coefficients when progress says to stop. Throws InvalidInput where sizes do not agree.
Relief find_relief(const FittedSkin& skin, const ReliefModel& model, const std::vector<Sighting>& sightings,
                   const ReliefOptions& options = {}, const Progress& progress = {});

}  // namespace mimetic
