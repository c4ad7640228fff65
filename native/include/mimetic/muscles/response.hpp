// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/attach.hpp>

namespace mimetic {

/// A person's skin and muscles relative to the assumed ones; M muscles, R regions.
struct SkinCalibration {
    Eigen::VectorXd stiffness;  ///< R factors on the attachment to the bone
    Eigen::VectorXd strength;   ///< M factors on the displacement at activation 1
    Points2 insertion_mm;       ///< M x 2, away from the midline and up, on the template
};

/// Factor on the attachment at every refined vertex, N; regions blend as the surface does. weights: N x R,
/// membership of each vertex in each region.
Eigen::VectorXd stiffness_factors(MatrixIn weights, const Eigen::VectorXd& factors);

/// Muscles (strengths included), then jaw and lids: Q modes on the skin's S control vertices.
struct ResponsiveModes {
    MatrixRows modes;         ///< Q x 3S, metres at the value 1
    MatrixRows by_stiffness;  ///< RQ x 3S, region by region: derivatives by the logarithm of the factor
    /// 2Q x 3S: derivatives by each muscle's insertion away from the midline, then up, per millimetre; 0
    /// where not requested.
    MatrixRows by_insertion;
};

/// A person's muscles and jaw on the skin, for one calibration after another.
class SkinResponse {
public:
    /// canonical: the template's own skin; weights: N x R, as for stiffness_factors.
    SkinResponse(std::shared_ptr<const SkinMesh> mesh, std::shared_ptr<const SkinMesh> canonical,
                 std::vector<MuscleEntry> muscles, MaterialTable materials, MatrixRows weights);

    /// Modes and derivatives, those by insertion for the muscles `moved`; one factorisation. Throws
    /// InvalidInput on a calibration of other muscles or regions.
    ResponsiveModes evaluate(const SkinCalibration& calibration, const std::vector<int>& moved) const;

private:
    MatrixRows held(const AttachedSkin& skin, const MatrixRows& responses) const;
    Eigen::VectorXd gains(const SparseRows& measured, const MatrixRows& pulled,
                          const MatrixRows& change) const;
    MatrixRows shifted(const AttachedSkin& skin, const SkinCalibration& calibration,
                       const std::vector<int>& moved, const Eigen::RowVector2d& step_mm) const;
    void check(const SkinCalibration& calibration, const std::vector<int>& moved) const;

    std::shared_ptr<const SkinMesh> mesh_, canonical_;
    std::vector<MuscleEntry> muscles_;
    MaterialTable materials_;
    MatrixRows weights_;
    MatrixRows bone_;  // 3 x 3N, of the bone under the skin, metres at value 1
    MatrixRows lids_;  // 4 x 3S
};

}  // namespace mimetic
