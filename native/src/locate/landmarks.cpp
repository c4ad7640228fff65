// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/locate/landmarks.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr double kLeastSize = 4;  // pixels an IPD

/// Components of the descriptors of all landmarks, and a 1.
Eigen::VectorXd evidence(const LandmarkStage& stage, const MatrixRows& descriptors) {
    const MatrixRows values = (descriptors.rowwise() - stage.mean.transpose()) * stage.basis.transpose();
    Eigen::VectorXd out(values.size() + 1);
    out << Eigen::Map<const Eigen::VectorXd>(values.data(), values.size()), 1.0;
    return out;
}

/// The view whose average face the places are most like.
const LandmarkView& likest_view(const LandmarkCascade& cascade, Points2In places) {
    const auto mismatch = [&](const LandmarkView& view) {
        const auto laid = similarity(view.start, places);
        return ((view.start * laid.leftCols<2>().transpose()).rowwise() + laid.col(2).transpose() - places)
            .squaredNorm();
    };
    return *std::min_element(cascade.views.begin(), cascade.views.end(),
                             [&](const auto& a, const auto& b) { return mismatch(a) < mismatch(b); });
}

}  // namespace

void LandmarkCascade::check() const {
    const auto count = static_cast<Eigen::Index>(names.size());
    require(count >= 3, "landmarks: at least three names are needed");
    require(reference.rows() == count && reference.allFinite(),
            "landmarks: reference must have a place for every name");
    require(!views.empty() && !stages.empty(), "landmarks: at least one view and one stage are needed");
    for (const auto& view : views) {
        require(view.start.rows() == count && view.start.allFinite() && view.sigma.size() == count &&
                    view.sigma.minCoeff() > 0 && view.sigma.allFinite(),
                "landmarks: a view must have a start and a sigma above 0 for every name");
    }
    for (const auto& stage : stages) {
        require(stage.cell > 0 && stage.cell <= 1, "landmarks: cell must be above 0 and at most 1");
        require(stage.mean.size() == kDescriptor && stage.basis.cols() == kDescriptor &&
                    stage.mean.allFinite() && stage.basis.allFinite(),
                "landmarks: mean and basis must be of descriptors");
        require(stage.regression.rows() == 2 * count &&
                    stage.regression.cols() == count * stage.basis.rows() + 1 && stage.regression.allFinite(),
                "landmarks: regression must map a stage's components to two values a name");
    }
}

Points2 landmark_start(const LandmarkCascade& cascade, const Eigen::Vector2d& pupil_right,
                       const Eigen::Vector2d& pupil_left, double yaw) {
    const Eigen::Vector2d across = pupil_left - pupil_right, middle = (pupil_left + pupil_right) / 2;
    Eigen::Matrix2d turn;
    turn << across.x(), -across.y(), across.y(), across.x();
    const auto& view = *std::min_element(
        cascade.views.begin(), cascade.views.end(),
        [&](const auto& a, const auto& b) { return std::abs(a.yaw - yaw) < std::abs(b.yaw - yaw); });
    return (view.start * turn.transpose()).rowwise() + middle.transpose();
}

FaceLandmarks find_landmarks(ColorView image, const LandmarkCascade& cascade, Points2In start) {
    check_image_size(image.rows, image.cols, "image");
    require(start.rows() == cascade.reference.rows() && start.allFinite(),
            "landmarks: start must have a finite place for every name");
    FaceLandmarks found;
    found.places = start;
    for (const auto& stage : cascade.stages) {
        const auto image_from_reference = similarity(cascade.reference, found.places);
        const Eigen::Matrix2d turn = image_from_reference.leftCols<2>();
        require(turn.allFinite() && turn.col(0).norm() >= kLeastSize,
                "landmarks: the face is too small, or the cascade lost it");
        const Eigen::VectorXd seen =
            evidence(stage, landmark_descriptors(image, found.places, cascade.reference, stage.cell));
        const Eigen::VectorXd shift = stage.regression * seen;
        found.places += Eigen::Map<const Points2>(shift.data(), start.rows(), 2) * turn.transpose();
    }
    const auto image_from_reference = similarity(cascade.reference, found.places);
    const LandmarkView& view = likest_view(cascade, found.places);
    found.yaw = view.yaw;
    found.sigma_px = view.sigma * image_from_reference.leftCols<2>().col(0).norm();
    return found;
}

FaceLandmarks settle_landmarks(ColorView image, const LandmarkCascade& cascade, Points2In start) {
    constexpr double kResized = .2;  // logarithm of the size, beyond what pupils well found leave to mend
    const auto size_of = [](Points2In places) { return (places.rowwise() - places.colwise().mean()).norm(); };
    const FaceLandmarks first = find_landmarks(image, cascade, start);
    const bool is_resized = std::abs(std::log(size_of(first.places) / size_of(start))) > kResized;
    return is_resized ? find_landmarks(image, cascade, first.places) : first;
}

}  // namespace mimetic
