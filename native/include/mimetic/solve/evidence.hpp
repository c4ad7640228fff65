// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <mimetic/solve/sightings.hpp>

namespace mimetic {

/// Factors about 1 on a person's skin and muscles, as one vector of P = R + 3n: logarithms of the stiffness
/// of R regions and of the strength of n strong muscles, then the shift of their insertions, away from the
/// midline (n) and up (n), in units of kInsertionUnit.
struct SkinFactors {
    static constexpr double kInsertionUnit = 4;  ///< mm
    int num_regions = 0;
    std::vector<int> strong;  ///< muscles that are active in the clip: indices among the values
    int num_values = 0;       ///< M: muscles, then articulators
    double stiffness_std = .5;
    double strength_std = .2;     ///< of the logarithms
    double insertion_std_mm = 2;  ///< along either axis

    Eigen::Index size() const { return num_regions + 3 * static_cast<Eigen::Index>(strong.size()); }
    Eigen::VectorXd prior_std() const;  ///< P, about 0
    void check() const;                 ///< throws InvalidInput: which, limit
};

/// One frame's normal equations in the columns [modes, their derivatives by parameter 1, 2, ...].
struct LinearFrame {
    Eigen::MatrixXd gram;   ///< (A F)^2 of the whitened columns, F free values and A - 1 parameters
    Eigen::VectorXd pull;   ///< A F: right-hand side
    std::vector<int> free;  ///< F: the active values, indices among all
    Eigen::VectorXd std;    ///< F, priors

    /// columns: 2K x A F, whitened, those of the modes first; displacement: 2K, whitened.
    LinearFrame(const Eigen::MatrixXd& columns, const Eigen::VectorXd& displacement, std::vector<int> free,
                Eigen::VectorXd std);

    /// columns: (A M) x 3S, modes of all M values, then their derivatives; std: M; values that stay within
    /// `at_rest` of 0 in the frame count as 0.
    LinearFrame(const FittedSkin& skin, const WhitenedSighting& seen, MatrixIn columns, VectorIn std,
                double at_rest);

    /// Measured displacements d = H v + n are linear in the values v of muscles and articulators. With their
    /// prior N(0, P) integrated out, d ~ N(0, I + H P H^T): the logarithm of that density, without the terms
    /// that do not depend on H, -|d|^2 / 2 and constants. H has the modes sum_a shares(a, j) columns(a, j),
    /// with strengths; shares: A x M, log_strength: M.
    double log_evidence(MatrixIn shares, VectorIn log_strength) const;
};

/// A maximum: where, standard deviations from the curvature there, the value.
struct Peak {
    Eigen::VectorXd place;
    Eigen::VectorXd std;
    double height = 0;
};

using Height = std::function<double(const Eigen::VectorXd&)>;

/// The maximum within `bound` of `start` in each coordinate, by damped Newton steps with derivatives by
/// finite differences: parameters are few and the function is cheap. It is called from several threads.
/// Stopped by progress, it returns the best point so far with the deviations 0.
Peak maximise(const Height& height, VectorIn start, double bound, const Progress& progress = {});

/// Log posterior of the factors given the measured displacements, near `base`, about which the modes were
/// linearised.
class SkinEvidence {
public:
    SkinEvidence(std::vector<LinearFrame> frames, SkinFactors factors, Eigen::VectorXd base);
    double log_probability(const Eigen::VectorXd& place) const;

private:
    std::vector<LinearFrame> frames_;
    SkinFactors factors_;
    Eigen::VectorXd base_;
    Eigen::VectorXd prior_std_;
};

}  // namespace mimetic
