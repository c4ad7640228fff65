// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <mimetic/contact/skin_contact.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kTolerance = 5e-5;  // m, of the shapes' sum against the correction of each frame
constexpr Eigen::Index kMaxShapes = 12;
constexpr Eigen::Index kReported = 50;  // frames between two calls of the progress

}  // namespace

// By the eigenvectors of the corrections' products [Sirovich 1987]
ContactShapes shapes_of_corrections(const MatrixRows& corrections, const std::vector<Eigen::Index>& frames,
                                    Eigen::Index num_frames) {
    if (frames.size() != static_cast<std::size_t>(corrections.rows()) ||
        std::any_of(frames.begin(), frames.end(), [&](auto i) { return i < 0 || i >= num_frames; })) {
        throw InvalidInput("each correction must be of one of " + std::to_string(num_frames) + " frames");
    }
    if (corrections.size() == 0) {
        return {MatrixRows(num_frames, 0), MatrixRows(0, corrections.cols())};
    }
    const Eigen::MatrixXd products = corrections * corrections.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(products);
    MatrixRows rest = corrections;
    ContactShapes shapes{MatrixRows::Zero(num_frames, kMaxShapes),
                         MatrixRows(kMaxShapes, corrections.cols())};
    Eigen::Index count = 0;
    while (count < std::min(kMaxShapes, corrections.rows()) && rest.cwiseAbs().maxCoeff() > kTolerance) {
        const Eigen::VectorXd over_time = solver.eigenvectors().col(corrections.rows() - 1 - count);
        const Eigen::RowVectorXd shape = over_time.transpose() * corrections;
        rest -= over_time * shape;
        Eigen::Index peak = 0;
        over_time.cwiseAbs().maxCoeff(&peak);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            shapes.values(frames[i], count) = over_time[static_cast<Eigen::Index>(i)] / over_time[peak];
        }
        shapes.offsets.row(count++) = over_time[peak] * shape;
    }
    shapes.values.conservativeResize(num_frames, count);
    shapes.offsets.conservativeResize(count, corrections.cols());
    return shapes;
}

ContactShapes contact_shapes(const SkinContact& contact, const std::vector<MotionPart>& parts,
                             const Progress& progress) {
    const auto num_seen = static_cast<Eigen::Index>(contact.vertices().size());
    const Eigen::Index num_frames = parts.empty() ? 0 : parts.front().values.rows();
    for (const MotionPart& part : parts) {
        if (part.values.rows() != num_frames || part.values.cols() != part.modes.rows() ||
            part.modes.cols() != 3 * num_seen) {
            throw InvalidInput("a part of the motion has other frames, modes or vertices than the contact");
        }
    }
    std::vector<Eigen::RowVectorXf> corrections;
    std::vector<Eigen::Index> frames;
    for (Eigen::Index i = 0; i < num_frames; ++i) {
        if (progress && i % kReported == 0 &&
            !progress(static_cast<double>(i) / static_cast<double>(num_frames))) {
            break;
        }
        Eigen::RowVectorXd moved = Eigen::RowVectorXd::Zero(3 * num_seen);
        for (const MotionPart& part : parts) {
            moved += part.values.row(i) * part.modes;
        }
        if (const auto corrected = contact.correction(Eigen::Map<const Points>(moved.data(), num_seen, 3))) {
            corrections.emplace_back(
                Eigen::Map<const Eigen::RowVectorXf>(corrected->data(), corrected->size()));
            frames.push_back(i);
        }
    }
    const auto num_moved = static_cast<Eigen::Index>(contact.moved().size());
    MatrixRows rows(corrections.size(), 3 * num_moved);
    for (std::size_t i = 0; i < corrections.size(); ++i) {
        rows.row(static_cast<Eigen::Index>(i)) = corrections[i].cast<double>();
    }
    return shapes_of_corrections(rows, frames, num_frames);
}

}  // namespace mimetic
