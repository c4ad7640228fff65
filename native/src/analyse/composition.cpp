// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/composition.hpp>
#include <mimetic/shared/checks.hpp>

namespace mimetic {
namespace {

constexpr double kNearHighest = .9;  // of the highest value: the span about which dominance fades
constexpr double kLeastHighest = 1e-6;

/// Where a part has one muscle near its highest, and what its say in it is.
struct Say {
    double highest = 0;         // of the absolute values, the part's strength included
    double begin = 0, end = 0;  // seconds
};

double time_of_row(const ExpressionPart& part, Eigen::Index row) {
    return part.start + part.length * static_cast<double>(row) / static_cast<double>(part.values.rows() - 1);
}

double log_alpha(double log_share, double size) {
    return log_share + 2 * std::log(std::max(kLeastHighest, size));
}

Say say_in(const ExpressionPart& part, Eigen::Index column) {
    Say say;
    const Eigen::ArrayXd sizes = part.strength * part.values.col(column).array().abs();
    say.highest = sizes.maxCoeff();
    Eigen::Index first = 0, last = sizes.size() - 1;
    while (sizes[first] < kNearHighest * say.highest) {
        ++first;
    }
    while (sizes[last] < kNearHighest * say.highest) {
        --last;
    }
    say.begin = time_of_row(part, first);
    say.end = time_of_row(part, last);
    return say;
}

/// size: of the part's value at that time, its strength included.
double log_weight(const Say& say, double log_share, double size, double seconds,
                  const CompositionOptions& options) {
    const double apart = std::max({0., say.begin - seconds, seconds - say.end});
    const double faded =
        log_alpha(log_share, say.highest) - options.fading * std::pow(apart, options.exponent);
    // What is held below its highest is not given up to an expression that leaves the muscle alone
    return std::max(faded, log_alpha(log_share, size));
}

/// A row of a table at a time of the part, between two rows in proportion.
Eigen::RowVectorXd row_at(const ExpressionPart& part, const MatrixRows& table, double seconds) {
    const auto last = static_cast<double>(table.rows() - 1);
    const double at = std::clamp((seconds - part.start) / part.length * last, 0., last);
    const auto before = std::min(static_cast<Eigen::Index>(at), table.rows() - 2);
    const double share = at - static_cast<double>(before);
    return part.strength * ((1 - share) * table.row(before) + share * table.row(before + 1));
}

void check_parts(const std::vector<ExpressionPart>& parts, VectorIn seconds) {
    require(!parts.empty(), "a composition needs an expression");
    require(seconds.allFinite(), "the times of a composition must be finite");
    for (const ExpressionPart& part : parts) {
        require(part.values.rows() >= 2 && part.values.cols() == parts.front().values.cols() &&
                    part.stds.rows() == part.values.rows() && part.stds.cols() == part.values.cols(),
                "the expressions of a composition need two rows or more, the same columns, and a standard "
                "deviation for each value");
        require(part.values.allFinite() && part.stds.allFinite(), "an expression's values must be finite");
        check_range("start of an expression", part.start, -1e6, 1e6);
        check_range("length of an expression", part.length, 1e-3, 1e6);
        check_range("strength of an expression", part.strength, 0, 10);
        check_range("dominance of an expression", part.dominance, 1e-6, 1e6);
    }
}

}  // namespace

void CompositionOptions::check() const {
    check_range("CompositionOptions.fading", fading, 0, 1000);
    check_range("CompositionOptions.exponent", exponent, .1, 4);
}

Composition compose_expressions(const std::vector<ExpressionPart>& parts, VectorIn seconds,
                                const CompositionOptions& options) {
    options.check();
    check_parts(parts, seconds);
    const Eigen::Index count = seconds.size(), width = parts.front().values.cols();
    const auto num_parts = static_cast<Eigen::Index>(parts.size());
    std::vector<std::vector<Say>> says(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
        for (Eigen::Index c = 0; c < width; ++c) {
            says[p].push_back(say_in(parts[p], c));
        }
    }
    Composition composed{MatrixRows::Zero(count, width), MatrixRows::Zero(count, width)};
    for (Eigen::Index i = 0; i < count; ++i) {
        // Logarithms: far from all of them every dominance is 0 in a double
        Eigen::ArrayXXd weights(num_parts, width), values(num_parts, width);
        for (Eigen::Index p = 0; p < num_parts; ++p) {
            const ExpressionPart& part = parts[static_cast<std::size_t>(p)];
            values.row(p) = row_at(part, part.values, seconds[i]);
            const double log_share = std::log(part.dominance);
            for (Eigen::Index c = 0; c < width; ++c) {
                const Say& say = says[static_cast<std::size_t>(p)][static_cast<std::size_t>(c)];
                weights(p, c) = log_weight(say, log_share, std::abs(values(p, c)), seconds[i], options);
            }
        }
        weights = (weights.rowwise() - weights.colwise().maxCoeff()).exp();
        weights.rowwise() /= weights.colwise().sum();
        for (Eigen::Index p = 0; p < num_parts; ++p) {
            const ExpressionPart& part = parts[static_cast<std::size_t>(p)];
            const Eigen::ArrayXXd stds = row_at(part, part.stds, seconds[i]).array();
            composed.values.row(i).array() += weights.row(p) * values.row(p);
            composed.stds.row(i).array() += (weights.row(p) * stds).square();
        }
    }
    composed.stds = composed.stds.cwiseSqrt();
    return composed;
}

MatrixRows from_rest(MatrixIn values) {
    require(values.rows() >= 2 && values.allFinite(), "a motion needs two rows or more of finite values");
    MatrixRows moved = values;
    const auto last = static_cast<double>(values.rows() - 1);
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
        const double share = static_cast<double>(i) / last;
        moved.row(i) -= (1 - share) * values.row(0) + share * values.row(values.rows() - 1);
    }
    return moved;
}

MatrixRows still_motion(VectorIn values, int num_rows, double rise, double fall) {
    check_range("rows of a still", num_rows, 3, 1e6);
    check_range("rise of a still", rise, 1e-3, num_rows);
    check_range("fall of a still", fall, 1e-3, num_rows);
    require(rise + fall <= num_rows - 1, "a still rises and falls in more time than it has");
    require(values.allFinite(), "a still's values must be finite");
    const auto step = [](double share) {
        const double s = std::clamp(share, 0., 1.);
        return s * s * (3 - 2 * s);
    };
    MatrixRows motion(num_rows, values.size());
    for (int i = 0; i < num_rows; ++i) {
        motion.row(i) = std::min(step(i / rise), step((num_rows - 1 - i) / fall)) * values.transpose();
    }
    return motion;
}

}  // namespace mimetic
