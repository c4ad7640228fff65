// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <cmath>
#include <mimetic/shared/error.hpp>
#include <mimetic/solve/evidence.hpp>
#include <string>

namespace mimetic {

namespace {

std::vector<int> values_at_work(const Eigen::VectorXd& values, double at_rest) {
    std::vector<int> free;
    for (int j = 0; j < values.size(); ++j) {
        if (std::abs(values[j]) > at_rest) {
            free.push_back(j);
        }
    }
    return free;
}

/// Rows of the free values of each of the blocks of M rows.
std::vector<int> free_rows(const std::vector<int>& free, Eigen::Index num_rows, Eigen::Index num_values) {
    std::vector<int> rows;
    for (Eigen::Index first = 0; first < num_rows; first += num_values) {
        for (const int value : free) {
            rows.push_back(static_cast<int>(first) + value);
        }
    }
    return rows;
}

Eigen::MatrixXd columns_of(const FittedSkin& skin, const WhitenedSighting& seen, MatrixIn columns,
                           const std::vector<int>& free) {
    const Eigen::Index num_values = seen.sighting().values.size();
    if (num_values == 0 || columns.rows() == 0 || columns.rows() % num_values != 0) {
        throw InvalidInput("columns must be of all " + std::to_string(num_values) +
                           " values of the sighting, in blocks");
    }
    const MatrixRows moving = columns(free_rows(free, columns.rows(), num_values), Eigen::all);
    const Sighting& at = seen.sighting();
    return seen.in_picture(modes_at(skin.stencils, at.vertices, at.barycentric, moving));
}

}  // namespace

void SkinFactors::check() const {
    if (num_regions < 0 || num_values <= 0) {
        throw InvalidInput("factors must be of some regions and values");
    }
    for (const int muscle : strong) {
        if (muscle < 0 || muscle >= num_values) {
            throw InvalidInput("muscle " + std::to_string(muscle) + " is none of " +
                               std::to_string(num_values) + " values");
        }
    }
}

Eigen::VectorXd SkinFactors::prior_std() const {
    const auto count = static_cast<Eigen::Index>(strong.size());
    Eigen::VectorXd std(size());
    std << Eigen::VectorXd::Constant(num_regions, stiffness_std),
        Eigen::VectorXd::Constant(count, strength_std),
        Eigen::VectorXd::Constant(2 * count, insertion_std_mm / kInsertionUnit);
    return std;
}

LinearFrame::LinearFrame(const Eigen::MatrixXd& columns, const Eigen::VectorXd& displacement,
                         std::vector<int> free_in, Eigen::VectorXd std_in)
    : gram(Eigen::MatrixXd::Zero(columns.cols(), columns.cols())),
      pull(columns.transpose() * displacement),
      free(std::move(free_in)),
      std(std::move(std_in)) {
    gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
    gram.triangularView<Eigen::Upper>() = gram.transpose();
}

LinearFrame::LinearFrame(const FittedSkin& skin, const WhitenedSighting& seen, MatrixIn columns,
                         VectorIn std_in, double at_rest)
    : LinearFrame(columns_of(skin, seen, columns, values_at_work(seen.sighting().values, at_rest)),
                  seen.displacement(), values_at_work(seen.sighting().values, at_rest),
                  std_in(values_at_work(seen.sighting().values, at_rest))) {}

double LinearFrame::log_evidence(MatrixIn shares, VectorIn log_strength) const {
    const auto size = static_cast<Eigen::Index>(free.size());
    const Eigen::ArrayXd scale = std.array() * log_strength(free).array().exp();
    Eigen::MatrixXd half_way = Eigen::MatrixXd::Zero(size, gram.cols());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(size, size);
    Eigen::VectorXd all_pull = Eigen::VectorXd::Zero(size);
    for (Eigen::Index a = 0; a < shares.rows(); ++a) {
        const Eigen::VectorXd own = shares(a, free).transpose().array() * scale;
        half_way += own.asDiagonal() * gram.middleRows(a * size, size);
        all_pull += own.cwiseProduct(pull.segment(a * size, size));
    }
    for (Eigen::Index a = 0; a < shares.rows(); ++a) {
        const Eigen::VectorXd own = shares(a, free).transpose().array() * scale;
        normal += half_way.middleCols(a * size, size) * own.asDiagonal();
    }
    const Eigen::LLT<Eigen::MatrixXd> root(normal);
    const Eigen::VectorXd half = root.matrixL().solve(all_pull);
    return .5 * half.squaredNorm() - root.matrixLLT().diagonal().array().log().sum();
}

SkinEvidence::SkinEvidence(std::vector<LinearFrame> frames, SkinFactors factors, Eigen::VectorXd base)
    : frames_(std::move(frames)),
      factors_(std::move(factors)),
      base_(std::move(base)),
      prior_std_(factors_.prior_std()) {
    factors_.check();
    const Eigen::Index num_blocks = 1 + factors_.num_regions + 2;
    for (const LinearFrame& frame : frames_) {
        const auto num_free = static_cast<Eigen::Index>(frame.free.size());
        if (frame.gram.rows() != num_blocks * num_free || frame.std.size() != num_free) {
            throw InvalidInput("a frame's equations must have modes and their changes by " +
                               std::to_string(num_blocks - 1) + " parameters");
        }
    }
    if (base_.size() != factors_.size()) {
        throw InvalidInput("base must have " + std::to_string(factors_.size()) + " parameters");
    }
}

double SkinEvidence::log_probability(const Eigen::VectorXd& place) const {
    const auto num_strong = static_cast<Eigen::Index>(factors_.strong.size());
    const Eigen::Index num_regions = factors_.num_regions;
    const Eigen::VectorXd change = place - base_;
    MatrixRows shares = MatrixRows::Zero(1 + num_regions + 2, factors_.num_values);
    Eigen::VectorXd strength = Eigen::VectorXd::Zero(factors_.num_values);
    shares.row(0).setOnes();
    shares.middleRows(1, num_regions).colwise() = change.head(num_regions);
    for (Eigen::Index i = 0; i < num_strong; ++i) {
        const int muscle = factors_.strong[static_cast<std::size_t>(i)];
        strength[muscle] = place[num_regions + i];
        for (int axis = 0; axis < 2; ++axis) {
            shares(1 + num_regions + axis, muscle) =
                SkinFactors::kInsertionUnit * change[num_regions + (1 + axis) * num_strong + i];
        }
    }
    double sum = -.5 * place.cwiseQuotient(prior_std_).squaredNorm();
    for (const LinearFrame& frame : frames_) {
        sum += frame.log_evidence(shares, strength);
    }
    return sum;
}

}  // namespace mimetic
