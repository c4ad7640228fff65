// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Cholesky>
#include <mimetic/solve/model_error.hpp>
#include <mimetic/solve/solve.hpp>
#include <mimetic/surface/surface.hpp>
#include <vector>

namespace mimetic {

/// A fitted head's skin at rest in the frame that it was fitted to, with names for its points: S control
/// vertices, R refined ones.
struct FittedSkin {
    SparseRows stencils;               ///< R x S
    Points normals;                    ///< R x 3, unit, outwards
    Points neutral;                    ///< S x 3, metres, head frame
    Camera camera;                     ///< of the footage
    Eigen::Isometry3d reference_pose;  ///< camera from head in the fitted frame, metres

    /// Throws InvalidInput where sizes do not agree or a number is not finite.
    FittedSkin(const SubdividedMesh& surface, Points neutral, const Camera& camera,
               const Eigen::Isometry3d& reference_pose);

    /// Where the fitted frame was taken from: metres, head frame.
    Eigen::Vector3d camera_place() const;
    /// K x 3: unit vectors from there to control vertices, head frame. Throws InvalidInput.
    Points rays_to(const std::vector<int>& vertices) const;
};

/// K points of the skin in one frame, and the state that the capture gave it.
struct Sighting {
    int frame = 0;                       ///< number in the footage
    Eigen::Isometry3d camera_from_head;  ///< metres
    Eigen::VectorXd values;              ///< M, of muscles and articulators
    Triangles vertices;                  ///< K x 3, refined vertices around each point
    Points barycentric;                  ///< K x 3
    Points2 pixels;                      ///< K x 2, by flow alone
    Rows<double, 4> information;         ///< K x (2 x 2), pixels^-2
    int num_outline = 0;  ///< the last of the K are seen as the face's outline, and not by flow

    void check() const;  ///< throws InvalidInput where sizes do not agree or a number is not finite
};

/// Of the frame that a tracker has just advanced to: at most 350 of its points, a representative sample,
/// spread evenly.
/// outline: what `FaceTracker::outline` sees in the frame, all of it.
Sighting make_sighting(int frame, const FrameEstimate& estimate, const SkinObservations& seen,
                       const SkinObservations& outline = {});

/// What modes (M x 3S, metres) move points of the skin by: 3K x M, x, y and z of each point in turn.
/// vertices, barycentric: K x 3, as a sighting has them. Throws InvalidInput for a vertex that is not there.
MatrixRows modes_at(const SparseRows& stencils, TrianglesIn vertices, PointsIn barycentric, MatrixIn modes);

/// The points of all sightings, each of them once, sorted.
struct DistinctPoints {
    Triangles vertices;                   ///< P x 3
    Points barycentric;                   ///< P x 3
    std::vector<std::vector<int>> index;  ///< of each sighting: which of these its own points are, K
};
DistinctPoints distinct_points(const std::vector<Sighting>& sightings);

/// Model error beside what calibration may change. The tracker's own, after calibration, has an eighth of the
/// shape error.
inline constexpr ModelError kSightingError{.3e-3, 4e-3, .1};

/// A frame's measured displacements in standard deviations of their own noise.
struct WeighedSighting {
    Eigen::VectorXd displacement;  ///< 2K, from the neutral
    std::vector<Eigen::Matrix<double, 2, 3>>
        by_point;            ///< K: derivatives of these by the point, a metre in the head frame
    Eigen::MatrixXd errors;  ///< 2K x E: one standard deviation each of pose and smooth model error

    /// Whitened displacements (2K x C) of motions of the points, 3K x C metres.
    Eigen::MatrixXd in_picture(MatrixIn moved) const;
};

/// Displacements from the neutral, and their common errors that are no motion of the skin.
/// rest: the visible points in the head frame, 3K; modes: those of the capture at these points, 3K x M.
WeighedSighting weigh(const Sighting& sighting, VectorIn rest, MatrixIn modes, const FittedSkin& skin,
                      const ModelError& error = kSightingError);

/// The same with pose and smooth model error eliminated, its noise of unit variance.
class WhitenedSighting {
public:
    /// modes: those that the capture used, M x 3S.
    WhitenedSighting(const FittedSkin& skin, const Sighting& sighting, MatrixIn modes,
                     const ModelError& error = kSightingError);

    const Sighting& sighting() const { return sighting_; }
    const Eigen::VectorXd& displacement() const { return displacement_; }  ///< 2K
    Eigen::MatrixXd in_picture(MatrixIn moved) const;  ///< as WeighedSighting has it, whitened

private:
    Sighting sighting_;
    WeighedSighting weighed_;
    Eigen::LLT<Eigen::MatrixXd> root_;
    Eigen::VectorXd displacement_;
};

}  // namespace mimetic
