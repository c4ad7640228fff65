// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/locate.hpp>

namespace mimetic {

/// Heights of brows and mouth corners below the pupils, the lips' height and the mouth's width, pupil
/// distances; nan where a feature was not found. They say what changed from frame to frame, not what is
/// neutral: how high brows sit at rest differs between people.
using Expression = Eigen::Matrix<double, 6, 1>;
using Expressions = Rows<double, 6>;  ///< one a frame

/// How much a face in an image is at rest, 0 to 1: frontal, level, eyes open and mouth at rest. Throws
/// InvalidInput for a face without pupils, alae and mouth corners.
double rest_score(ColorView image, const FaceFeatures& face);

/// What a face shows beyond smooth shades, grey levels. An encoder that is short of bits, a blur and a bad
/// focus take it away.
double face_detail(ColorView image, const FaceFeatures& face);

/// Throws InvalidInput for a face without pupils, mouth corners and lips.
Expression expression_of(const FaceFeatures& face);

/// F: how usual each frame's expression is within its clip, 0 to 1. Each part of a face rests in more of a
/// clip's frames than not, though rarely all at once; so the median of each value is its rest, whatever the
/// person looks like. scores: F of rest_score; where most frames are plainly not at rest, a long smile, the
/// others alone say what is usual.
Eigen::VectorXd usual_expression(const Expressions& expressions, VectorIn scores);

/// F: how many frames share each frame's expression, as a part of the most, 0 to 1. A face comes back to the
/// same rest, and all of it at once; what moves is elsewhere in every frame. weights: F, of what the frames
/// count for.
Eigen::VectorXd shared_expression(const Expressions& expressions, VectorIn weights);

/// F: which frames of a clip serve best as its reference; the greatest is the best. details: F of
/// face_detail, which count by what they tell of motion, the square of the gradients, beside what the clip's
/// better frames have.
Eigen::VectorXd chances_of_rest(VectorIn scores, VectorIn details, const Expressions& expressions);

}  // namespace mimetic
