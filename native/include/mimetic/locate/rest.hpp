// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/locate.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// Heights of brows and mouth corners below the pupils, the lips' height and the mouth's width, pupil
/// distances; nan where a feature was not found. They measure change from frame to frame, not the
/// neutral: the height of brows at rest differs between people.
using Expression = Eigen::Matrix<double, 6, 1>;
using Expressions = Rows<double, 6>;  ///< one a frame

/// What tells of a face in an image whether it is at rest. Contrasts and brightness are relative to the
/// skin's brightness.
struct RestSigns {
    double frontal = 0;           ///< 0 to 1: how sure the finder is of a face that is frontal and level
    double mouth_contrast = 0;    ///< teeth and an open mouth's dark add to it
    double mouth_edges = 0;       ///< likewise
    double cheek_contrast = 0;    ///< the smile's fold adds to it
    double pupil_brightness = 0;  ///< closed lids are as bright as skin
};

/// Throws InvalidInput for a face without pupils, alae and mouth corners.
RestSigns rest_signs(ColorView image, const FaceFeatures& face);

/// F: how much a face is at rest in each of a clip's frames, 0 to 1: frontal, level, eyes open and mouth at
/// rest. A camera's sharpening multiplies all contrasts: where nearly all frames have more than smiles add to
/// those usual at rest, they are compared with those of the clip's smoother frames.
Eigen::VectorXd rest_scores(const std::vector<RestSigns>& frames);

/// Fine detail of a face, grey levels. Strong compression, motion blur and defocus remove it.
double face_detail(ColorView image, const FaceFeatures& face);

/// Throws InvalidInput for a face without pupils, mouth corners and lips.
Expression expression_of(const FaceFeatures& face);

/// F: how near each frame's expression is to the clip's median, 0 to 1. Each part of a face is at rest in
/// most of a clip's frames, though rarely all at once; so the median of each value is its rest, whatever the
/// person looks like. scores: F of rest_scores; where most frames are clearly not at rest (a long smile), the
/// median is of the others alone. rest: the frame that is known to show rest, which the others are compared
/// with instead of the median.
Eigen::VectorXd usual_expression(const Expressions& expressions, VectorIn scores,
                                 std::optional<Eigen::Index> rest = {});

/// How many frames, this one among them, have its expression but for what a still face's features seem to
/// move.
Eigen::Index num_alike(const Expressions& expressions, Eigen::Index frame);

/// Frames by falling chance, but those last whose expression a frame before them has (as num_alike counts).
std::vector<int> distinct_first(VectorIn chances, const Expressions& expressions);

/// F: density of frames about each frame's expression, relative to the largest, 0 to 1. A face returns to the
/// same rest as a whole; moving, it differs in every frame. weights: F, of the frames.
Eigen::VectorXd shared_expression(const Expressions& expressions, VectorIn weights);

/// F: which frames of a clip serve best as its reference; the greatest is the best. details: F of
/// face_detail, which count by the information that they give on motion, the square of the gradients,
/// relative to the clip's better frames.
Eigen::VectorXd chances_of_rest(VectorIn scores, VectorIn details, const Expressions& expressions);

/// F: how little a frame serves as rest by what moves from frame to frame, the least is the best. values: F x
/// M, of what moves the skin, relative to any one of the frames: what relaxes below that is negative. A face
/// returns to its rest, and moves by what contracts: counted are the density of frames about a frame's
/// values, and by how much they are above what they are in the clip's lowest frames, so that a smile that
/// lasts is none. lids: F x L, of each lid its way from open (0) to shut (1): one that is more shut than in
/// the clip's open frames winks, blinks or looks down. scores, details: F, as for chances_of_rest.
/// covered_lids: C x L, of frames that serve as no rest since a hand is before the face: they, too, tell how
/// open eyes are.
Eigen::VectorXd costs_of_rest(MatrixIn values, MatrixIn lids, VectorIn scores, VectorIn details,
                              MatrixIn covered_lids);

}  // namespace mimetic
