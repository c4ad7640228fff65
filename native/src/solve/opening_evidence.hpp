// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "detail_solver.hpp"
#include "opening_lines.hpp"
#include "tracked_face.hpp"

namespace mimetic {

/// Evidence of one opening's lines on the values. A person's and the networks' constant offset from the
/// model is a state of its own: learned in the reference frame, where the model is at rest, it is subtracted
/// from then on, and its remaining uncertainty counts as error (Schmidt-Kalman filter). As lids close, the
/// upper margin's offset changes into the lower one's: on every person closed lids meet.
class OpeningEvidence {
public:
    OpeningEvidence(const TrackedFace& face, const FeatureOpening& opening);

    /// The reference frame: learns the offset, and returns the state with what shuts as it is there.
    FaceState learn(const FaceState& at_rest, const SeenOpening& seen, double interpupillary);

    /// Information and right-hand side of the measurement; zero without one. The pose has no part in it.
    StepPrior terms(const FaceState& state, const SeenOpening& seen, double interpupillary) const;

    /// The measurement's equations of detail, at a state that the values do not leave.
    DetailTerms detail_terms(const FaceState& state, const SeenOpening& seen, double interpupillary) const;

    /// The state with this opening's lids where they were seen, whatever they were before.
    FaceState with_lids(FaceState state, const SeenOpening& seen, double interpupillary) const;

    const OpeningLines& lines() const { return lines_; }
    const Eigen::VectorXd& bias() const { return bias_; }  ///< K, interpupillary distances
    const Eigen::MatrixXd& bias_covariance() const { return bias_covariance_; }

private:
    /// K differences, their derivatives and their covariance.
    struct Rows {
        Eigen::VectorXd offsets;
        Eigen::MatrixXd by_values;
        Eigen::MatrixXd by_detail;
        Eigen::MatrixXd covariance;
    };

    bool is_eye() const { return lines_.opening().lid_upper >= 0; }
    std::optional<Rows> rows_at(const FaceState& state, const SeenOpening& seen, double interpupillary) const;
    double plausibility(const Rows& rows) const;

    const TrackedFace& face_;
    OpeningLines lines_;
    Eigen::VectorXd bias_;
    Eigen::MatrixXd bias_covariance_;
};

}  // namespace mimetic
