// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

/// Values of the descriptor of a landmark: 4 x 4 places, 8 orientations of the gradient at each.
inline constexpr int kDescriptor = 128;

/// One step of the cascade: a linear map from descriptors round the landmarks to their displacement.
struct LandmarkStage {
    double cell = 0;        ///< between the places of a descriptor, interpupillary distances
    Eigen::VectorXd mean;   ///< kDescriptor
    MatrixRows basis;       ///< M x kDescriptor, principal components of descriptors
    MatrixRows regression;  ///< O x (L M + 1), the constant last; O is 2 L: x and y of each landmark's shift
};

/// Heads of similar yaw: where the search for their landmarks starts, and its error on people outside the
/// training set.
struct LandmarkView {
    double yaw = 0;         ///< degrees, the middle of the view
    Points2 start;          ///< L x 2, average places with the pupils at (-0.5, 0) and (0.5, 0)
    Eigen::VectorXd sigma;  ///< L, standard deviation along x and y, interpupillary distances
};

/// Places of a face's landmarks by supervised descent [Xiong and De la Torre 2013]: a cascade of linear
/// regressions from orientations of gradients round the landmarks.
struct LandmarkCascade {
    std::vector<std::string> names;  ///< L
    Points2 reference;               ///< L x 2, interpupillary distances: what every shape is aligned with
    std::vector<LandmarkView> views;
    std::vector<LandmarkStage> stages;

    void check() const;  ///< throws InvalidInput: field, size
};

/// The cascade's estimate of one face.
struct FaceLandmarks {
    Points2 places;            ///< L x 2, pixels
    Eigen::VectorXd sigma_px;  ///< L
    double yaw = 0;            ///< degrees, of the view whose sigma was taken
};

/// Descriptors of a picture round places: L x kDescriptor.
/// places: L x 2, pixels; reference: L x 2; cell: as in a stage. The picture is first turned and
/// scaled so that the places are best aligned with the reference.
MatrixRows landmark_descriptors(ColorView image, Points2In places, Points2In reference, double cell);

/// The cascade from a start (L x 2, pixels). Throws InvalidInput.
FaceLandmarks find_landmarks(ColorView image, const LandmarkCascade& cascade, Points2In start);

/// The same; where the face proves to be of another size than the start, it starts again from its result.
FaceLandmarks settle_landmarks(ColorView image, const LandmarkCascade& cascade, Points2In start);

/// The start from pupils (pixels) and the view nearest to a yaw (degrees).
Points2 landmark_start(const LandmarkCascade& cascade, const Eigen::Vector2d& pupil_right,
                       const Eigen::Vector2d& pupil_left, double yaw);

/// image_from_reference (2 x 3), the similarity that best aligns the reference places with others.
Eigen::Matrix<double, 2, 3> similarity(Points2In from, Points2In to);

}  // namespace mimetic
