// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/muscles/response.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kInsertionStep = 1.0;  // mm, for differences: footprints are ten times as wide

/// Rows of N x 3 values from rows of S x 3.
MatrixRows refined(const SparseRows& stencils, const MatrixRows& rows) {
    MatrixRows result(rows.rows(), 3 * stencils.rows());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        const Eigen::Map<const Points> own(rows.row(i).data(), stencils.cols(), 3);
        Eigen::Map<Points>(result.row(i).data(), stencils.rows(), 3) = stencils * own;
    }
    return result;
}

MatrixRows stacked(const MatrixRows& above, const MatrixRows& below) {
    MatrixRows rows(above.rows() + below.rows(), above.cols());
    rows << above, below;
    return rows;
}

MatrixRows bone_under(const std::shared_ptr<const SkinMesh>& mesh) {
    const Jaw jaw(mesh);
    return jaw_under_skin(jaw, head_on_jaw(mesh, jaw));
}

}  // namespace

Eigen::VectorXd stiffness_factors(MatrixIn weights, const Eigen::VectorXd& factors) {
    if (weights.cols() != factors.size()) {
        throw InvalidInput("got factors of " + std::to_string(factors.size()) + " regions, there are " +
                           std::to_string(weights.cols()));
    }
    return (weights * factors.array().log().matrix()).array().exp();
}

SkinResponse::SkinResponse(std::shared_ptr<const SkinMesh> mesh, std::shared_ptr<const SkinMesh> canonical,
                           std::vector<MuscleEntry> muscles, MaterialTable materials, MatrixRows weights)
    : mesh_(std::move(mesh)),
      canonical_(std::move(canonical)),
      muscles_(std::move(muscles)),
      materials_(std::move(materials)),
      weights_(std::move(weights)),
      bone_(bone_under(mesh_)),
      lids_(lid_modes(mesh_).leftCols(3 * mesh_->head().num_skin_vertices)) {
    if (weights_.rows() != mesh_->vertices().rows()) {
        throw InvalidInput("got weights of " + std::to_string(weights_.rows()) + " vertices, there are " +
                           std::to_string(mesh_->vertices().rows()));
    }
}

ResponsiveModes SkinResponse::evaluate(const SkinCalibration& calibration,
                                       const std::vector<int>& moved) const {
    check(calibration, moved);
    const AttachedSkin skin(*mesh_, materials_, stiffness_factors(weights_, calibration.stiffness));
    const std::vector<PlacedMuscle> placed =
        place_muscles(*canonical_, *mesh_, muscles_, calibration.insertion_mm);
    const SparseRows measured = measured_rows(*mesh_, placed);
    const Pulled pulled = pull(skin, mesh_->surface(), placed, measured);
    const Eigen::Index count = pulled.responses.rows();
    const MatrixRows raw = stacked(pulled.responses, skin.respond(skin.foundation_forces(bone_)));
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(raw.rows());
    scale.head(count) = pulled.strengths.cwiseProduct(calibration.strength);
    const MatrixRows forces = held(skin, raw);
    const Eigen::Index num_modes = raw.rows() + lids_.rows();
    ResponsiveModes result{stacked(scale.asDiagonal() * raw, lids_),
                           MatrixRows::Zero(weights_.cols() * num_modes, raw.cols()),
                           MatrixRows::Zero(2 * num_modes, raw.cols())};
    for (Eigen::Index region = 0; region < weights_.cols(); ++region) {
        MatrixRows shares(forces.rows(), forces.cols());
        for (Eigen::Index v = 0; v < weights_.rows(); ++v) {
            shares.middleCols<3>(3 * v) = weights_(v, region) * forces.middleCols<3>(3 * v);
        }
        MatrixRows change = skin.respond(shares);
        change.topRows(count) += gains(measured, pulled.responses, change).asDiagonal() * pulled.responses;
        result.by_stiffness.middleRows(region * num_modes, raw.rows()) = scale.asDiagonal() * change;
    }
    for (int axis = 0; axis < 2 && !moved.empty(); ++axis) {
        const Eigen::RowVector2d step = kInsertionStep * Eigen::RowVector2d::Unit(axis);
        const MatrixRows slope =
            (shifted(skin, calibration, moved, step) - shifted(skin, calibration, moved, -step)) /
            (2 * kInsertionStep);
        for (std::size_t i = 0; i < moved.size(); ++i) {
            result.by_insertion.row(axis * num_modes + moved[i]) = slope.row(static_cast<Eigen::Index>(i));
        }
    }
    return result;
}

// K du / d log factor = K_region (feet - u), K_region the region's share of the attachment: these are its
// forces on the skin (Q x 3N), whose attachment points have moved too.
MatrixRows SkinResponse::held(const AttachedSkin& skin, const MatrixRows& responses) const {
    MatrixRows stretched = -refined(mesh_->stencils(), responses);
    stretched.bottomRows(bone_.rows()) += bone_;
    return skin.foundation_forces(stretched);
}

// Relative change of the strengths, so that excursions stay as the responses change.
Eigen::VectorXd SkinResponse::gains(const SparseRows& measured, const MatrixRows& pulled,
                                    const MatrixRows& change) const {
    Eigen::VectorXd gains(pulled.rows());
    for (Eigen::Index i = 0; i < gains.size(); ++i) {
        const Eigen::RowVector3d at = motion_at(measured, i, pulled.row(i));
        gains[i] = -at.dot(motion_at(measured, i, change.row(i))) / at.squaredNorm();
    }
    return gains;
}

MatrixRows SkinResponse::shifted(const AttachedSkin& skin, const SkinCalibration& calibration,
                                 const std::vector<int>& moved, const Eigen::RowVector2d& step_mm) const {
    std::vector<PlacedMuscle> placed;
    placed.reserve(moved.size());
    for (const int i : moved) {
        placed.push_back(place_muscle(*canonical_, *mesh_, muscles_[i / 2], "LR"[i % 2],
                                      calibration.insertion_mm.row(i) + step_mm));
    }
    const Pulled pulled = pull(skin, mesh_->surface(), placed, measured_rows(*mesh_, placed));
    return pulled.strengths.cwiseProduct(calibration.strength(moved)).asDiagonal() * pulled.responses;
}

void SkinResponse::check(const SkinCalibration& calibration, const std::vector<int>& moved) const {
    const auto count = static_cast<Eigen::Index>(2 * muscles_.size());
    if (calibration.strength.size() != count || calibration.insertion_mm.rows() != count) {
        throw InvalidInput("the calibration is of " + std::to_string(calibration.strength.size()) +
                           " muscles, there are " + std::to_string(count));
    }
    for (const int i : moved) {
        if (i < 0 || i >= count) {
            throw InvalidInput("there is no muscle " + std::to_string(i) + " of " + std::to_string(count));
        }
    }
}

}  // namespace mimetic
