// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/corrections.hpp>

#include "face_state.hpp"

namespace mimetic {

/// Corrections of one frame, linearised at a state: rows * step = residual, each with a standard deviation.
struct CorrectionRows {
    MatrixRows rows;           // R x (6 + M)
    Eigen::VectorXd residual;  // R
    Eigen::VectorXd std;       // R

    Eigen::MatrixXd information() const;
    Eigen::VectorXd pull() const;
};

CorrectionRows linearised(const Correction& correction, const Camera& camera, const FaceState& state);

/// How far the pictures' evidence is off in the frames around corrected ones: the expectation of a Gaussian
/// process, given its values in the rows of the corrections.
class EvidenceBias {
public:
    EvidenceBias(const FaceMotion& motion, const std::vector<Correction>& corrections);

    /// rows, one a correction, with the whole shift that each of them asks for as residual; evidence: the
    /// values that the pictures show in the corrected frames, which a shift leaves within the bounds.
    void fit(const std::vector<CorrectionRows>& rows, const std::vector<Eigen::VectorXd>& evidence);

    /// 6 + M: by which the evidence of a frame is to be moved.
    Eigen::VectorXd shift(int index) const;

private:
    void solve();
    bool bind(const std::vector<Eigen::VectorXd>& evidence);

    const FaceMotion& motion_;
    const std::vector<Correction>& corrections_;
    Eigen::VectorXd variance_;                 // 6 + M
    std::vector<CorrectionRows> rows_;         // of each correction, those of its bounds last
    std::vector<std::vector<bool>> is_bound_;  // of each correction, of each value
    std::vector<Eigen::VectorXd> sources_;     // of each correction, 6 + M: what its rows add
};

}  // namespace mimetic
