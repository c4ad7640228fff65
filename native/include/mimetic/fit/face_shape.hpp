// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Principal components of a shape whose likely deformations are known.
struct PrincipalShapes {
    Eigen::MatrixXd shares;     ///< N x K, of the deformations in each component; columns of unit length
    Eigen::VectorXd variances;  ///< K, of each component over the vertices, metres^2 in all, falling
};

/// The directions in which a sum of deformations (N x 3V, each taken with a coefficient of unit variance)
/// varies most over some of the vertices, largest first, at most `most`. Of each, the largest share is
/// positive: the sign of a component does not depend on the eigensolver. Throws InvalidInput for vertices out
/// of range.
PrincipalShapes principal_shapes(MatrixIn deformations, const std::vector<int>& seen, int most);

/// Forces on skin (S x 3, metres, mirrored at x = 0), newtons: N x 3S. At each of the places and at the place
/// opposite, spread over the face by a Gaussian of `radius`, along each axis; parity 1: symmetric, -1:
/// antisymmetric. Forces that cancel themselves are left out.
MatrixRows paired_pulls(PointsIn skin, const std::vector<int>& places, const std::vector<bool>& on_face,
                        double radius, int parity);

/// Principal components over the face of the prior exp(-energy) of an elastic skin [Terzopoulos 1988], rms
/// `spread` metres over the face: K x 3S, largest first, none with less than `least_variance` of the first's.
/// pulls: N x 3S, newtons; responses: displacements under them, N x 3S, metres. Throws InvalidInput where
/// sizes do not agree or the responses are not those of an elastic skin.
MatrixRows elastic_modes(MatrixIn pulls, MatrixIn responses, const std::vector<int>& face, double spread,
                         double least_variance);

/// K x S: the height at each point of the skin (S x 3, metres, a vertex a row) of a Gaussian bump of s.d.
/// `radius` round each place, divided by one number, so that the root of the sum of squares is 1 where it is
/// largest. Throws InvalidInput for places that are no vertices, or a radius that is not above 0.
MatrixRows bumps(PointsIn skin, const std::vector<int>& places, double radius);

/// Coefficients nearest to b in least squares, the shortest of them: A+ b.
Eigen::VectorXd nearest_coefficients(MatrixIn matrix, VectorIn values);

/// Modes (N x 3S) of a skin at rest (S x 3) whose lid slides on its eyeball: as far as they go seen from the
/// front, forth or back with the ball, fading with the distance to the lid's margin (s.d. `reach`, metres).
/// steepest: cosine to the front, beyond which the ball is not followed further back. Throws InvalidInput.
MatrixRows sliding_on_eyeball(MatrixIn modes, PointsIn skin, const std::vector<int>& margin,
                              const Eigen::Vector3d& centre, double reach, double steepest);

}  // namespace mimetic
