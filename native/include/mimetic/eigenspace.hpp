// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/image.hpp>
#include <mimetic/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

/// Gaussian density of image patches in their principal subspace and beside it [Moghaddam and Pentland
/// 1997]. A patch is width x height grey values, row by row, shifted and scaled to mean 0 and variance 1.
struct Eigenspace {
    int width = 0;
    int height = 0;
    Eigen::VectorXd mean;         ///< N = width * height
    MatrixRows basis;             ///< M x N, orthonormal rows
    Eigen::VectorXd eigenvalues;  ///< M, falling, above 0
    double rho = 0;               ///< mean of the N - M eigenvalues that are left out, above 0
    void check() const;           ///< throws InvalidInput: field, value, limit
};

/// Where a patch lies from an eigenspace; smaller is more alike.
struct SpaceDistance {
    double within = 0;          ///< distance in feature space: sum of y_i^2 / lambda_i
    double from = 0;            ///< distance from feature space: squared length of what the basis leaves
    double log_likelihood = 0;  ///< of the whole density; -infinity for a patch without contrast
};

/// Principal components of patches.
/// patches: K x N, K above num_modes; grey values of any gain and offset, at least 1e-6 of deviation each.
/// shrinkage: share of every eigenvalue that is replaced by their mean [Ledoit and Wolf 2004], 0 to 1.
Eigenspace train_eigenspace(MatrixIn patches, int width, int height, int num_modes, double shrinkage = 0.01);

/// patch: N grey values, row by row. Throws InvalidInput for another number of values.
SpaceDistance distance(const Eigenspace& space, VectorIn patch);

/// log_likelihood of every patch of the image, by correlation: (rows - height + 1) x (cols - width + 1), at
/// the patch's top left corner. -infinity where the patch has a deviation below one grey value.
MatrixRows likelihood_map(const Eigenspace& space, GrayView image);

struct SpaceSearchOptions {
    double smallest = 24;              ///< width of the patch in the image, pixels
    double largest = 0.9;              ///< part of the image's shorter side
    int steps_per_octave = 4;          ///< scales between a size and its double
    double largest_roll = 0.1745;      ///< in-plane turns searched on either side, radians
    int num_rolls = 3;                 ///< odd, evenly from -largest_roll to largest_roll
    int num_matches = 1;               ///< how many places that do not overlap
    double least_likelihood = -1e300;  ///< log; places below are dropped
    void check() const;                ///< throws InvalidInput: field, value, limit
};

/// A place, size and turn of the image that looks like one of the spaces.
struct SpaceMatch {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< pixels
    double width = 0;                                  ///< of the patch, pixels
    double roll = 0;                                   ///< radians, clockwise in the picture
    int view = 0;                                      ///< index of the space
    double log_likelihood = 0;
};

/// Maximum likelihood over position, scale, in-plane turn and view; the likeliest first.
/// views: spaces of one patch size. An image smaller than a patch gives no match.
std::vector<SpaceMatch> search_spaces(const std::vector<Eigenspace>& views, GrayView image,
                                      const SpaceSearchOptions& options = {});

/// A part of the face with an eigenspace of its own.
struct FaceModule {
    std::string name;
    Eigenspace space;
    double width = 0.3;                               ///< of its patch, in widths of the face's patch
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< mean, from the face's centre, in its widths
};

struct ModulePlaces {
    Points2 positions;               ///< pixels, a row a module
    Eigen::VectorXd log_likelihood;  ///< of each module by itself
    double prior = 0;                ///< squared Mahalanobis distance of the positions from their means
};

/// The modules' likeliest places together: the sum of the log likelihoods less half of `prior` is largest.
/// At most 6 modules. covariance: of all places (x0, y0, x1, ...), in squared widths of the face's patch.
/// Each module is sought within three deviations of its mean; joint over the `candidates` best of each.
ModulePlaces place_modules(const std::vector<FaceModule>& modules, MatrixIn covariance, GrayView image,
                           const SpaceMatch& face, int candidates = 4);

}  // namespace mimetic
