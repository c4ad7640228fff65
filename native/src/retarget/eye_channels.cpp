// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <mimetic/retarget/eye_channels.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <utility>

namespace mimetic {
namespace {

constexpr double kTurns = 2e-3;    // radians at value 1: what turns an eye by less does not turn it
constexpr double kOnly = .05;      // share of an eye's turn: what turns the other by less is that eye's own
constexpr double kFarthest = 1.3;  // radians, of a turn whose tangent is asked for
constexpr double kRank = 1e-3;     // of the readiest way, below which a bone does not turn an eye at all

/// How many ways channels turn an eye, up to two, and how readily the less ready one.
std::pair<int, double> reach(const std::vector<EyeChannel>& channels, const std::vector<int>& rows, int eye,
                             const Eigen::Vector3d& ahead) {
    Points turns(static_cast<Eigen::Index>(rows.size()), 3);
    for (Eigen::Index i = 0; i < turns.rows(); ++i) {
        const Eigen::RowVector3d turn =
            channels[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])].turns.row(eye);
        turns.row(i) = turn - turn.dot(ahead) * ahead.transpose();  // without torsion
    }
    const Eigen::VectorXd sizes = Eigen::JacobiSVD<Eigen::MatrixXd>(turns).singularValues();
    const int ways = static_cast<int>(std::min<Eigen::Index>((sizes.array() > kTurns).count(), 2));
    return {ways, ways > 0 ? sizes[ways - 1] : 0.};
}

}  // namespace

EyeTurns eye_rates(const EyeTurns& turned, bool is_aim, double step) {
    EyeTurns rates = EyeTurns::Zero();
    for (int eye = 0; eye < 2; ++eye) {
        const double size = turned.row(eye).norm();
        if (size > 0) {
            const double half = is_aim ? std::tan(size / 2) : size / 2;
            rates.row(eye) = turned.row(eye) * (half / size / step);
        }
    }
    return rates;
}

Points gaze_turns(VectorIn yaw, VectorIn pitch) {
    require(yaw.size() == pitch.size(), "a gaze has a yaw and a pitch in each frame");
    constexpr double radian = std::numbers::pi / 180;
    Points turns = Points::Zero(yaw.size(), 3);
    for (Eigen::Index i = 0; i < yaw.size(); ++i) {
        const double down = -std::sin(radian * pitch[i]);
        const double left = std::sin(radian * yaw[i]) * std::cos(radian * pitch[i]);
        const double ahead = std::cos(radian * yaw[i]) * std::cos(radian * pitch[i]);
        const double sine = std::hypot(down, left);
        const double scale = sine > 0 ? std::atan2(sine, ahead) / sine : 1;
        turns.row(i) << scale * down, 0, scale * left;
    }
    return turns;
}

EyeChannels::EyeChannels(std::vector<EyeChannel> channels, const Eigen::Vector3d& ahead,
                         std::vector<int> eyes)
    : channels_(std::move(channels)), ahead_(ahead.normalized()), eyes_(std::move(eyes)) {
    require(std::ranges::all_of(eyes_, [](int eye) { return eye == 0 || eye == 1; }),
            "eyes are 0, the left one, and 1");
    require(ahead.allFinite() && ahead.norm() > 0, "where eyes look at rest must be a finite direction");
    std::vector<Choice> own;
    for (const int eye : eyes_) {
        if (std::vector<int> rows = best({eye}); !rows.empty()) own.push_back({{eye}, std::move(rows)});
    }
    if (own.size() < eyes_.size()) {
        if (std::vector<int> both = best(eyes_); !both.empty()) own = {{eyes_, std::move(both)}};
    }
    choices_ = std::move(own);
}

bool EyeChannels::turns_only(const EyeChannel& channel, const std::vector<int>& eyes) const {
    const Eigen::Vector2d sizes = channel.turns.rowwise().norm();
    double least = sizes.maxCoeff(), others = 0;
    for (const int eye : {0, 1}) {
        const bool is_one = std::ranges::find(eyes, eye) != eyes.end();
        if (is_one) least = std::min(least, sizes[eye]);
        if (!is_one) others = sizes[eye];
    }
    return least > kTurns && others <= kOnly * least;
}

std::vector<int> EyeChannels::best(const std::vector<int>& eyes) const {
    std::map<std::pair<int, bool>, std::vector<int>> groups;
    for (std::size_t k = 0; k < channels_.size(); ++k) {
        if (turns_only(channels_[k], eyes)) {
            groups[{channels_[k].bone, channels_[k].is_aim}].push_back(static_cast<int>(k));
        }
    }
    std::vector<int> found;
    std::pair<int, double> farthest{0, 0.};
    for (const auto& [bone, rows] : groups) {
        if (const auto own = reach(channels_, rows, eyes.front(), ahead_); own > farthest) {
            farthest = own;
            found = rows;
        }
    }
    return found;
}

MatrixRows EyeChannels::values(const Eigen::Ref<const MatrixRows>& turns) const {
    require(turns.cols() == 6 && turns.allFinite(), "turns of both eyes are six finite numbers a row");
    MatrixRows values = MatrixRows::Zero(turns.rows(), static_cast<Eigen::Index>(channels_.size()));
    for (const auto& [eyes, channels] : choices_) {
        const auto num_channels = static_cast<Eigen::Index>(channels.size());
        const auto width = 3 * static_cast<Eigen::Index>(eyes.size());
        Eigen::MatrixXd rates(width, num_channels);
        Eigen::MatrixXd wanted(width, turns.rows());
        const bool is_aim = channels_[static_cast<std::size_t>(channels.front())].is_aim;
        for (std::size_t e = 0; e < eyes.size(); ++e) {
            const auto first = 3 * static_cast<Eigen::Index>(e);
            for (Eigen::Index k = 0; k < num_channels; ++k) {
                const EyeChannel& channel =
                    channels_[static_cast<std::size_t>(channels[static_cast<std::size_t>(k)])];
                rates.col(k).segment(first, 3) = channel.turns.row(eyes[e]).transpose();
            }
            for (Eigen::Index i = 0; i < turns.rows(); ++i) {
                const Eigen::Vector3d turn = turns.row(i).segment(3 * Eigen::Index{eyes[e]}, 3).transpose();
                const double size = turn.norm();
                const double scale = is_aim && size > 0 ? std::tan(std::min(size, kFarthest)) / size : 1.;
                wanted.col(i).segment(first, 3) = scale * turn;
            }
        }
        Eigen::JacobiSVD<Eigen::MatrixXd> solver(rates, Eigen::ComputeThinU | Eigen::ComputeThinV);
        solver.setThreshold(kRank);
        const Eigen::MatrixXd solved = solver.solve(wanted);
        for (Eigen::Index k = 0; k < num_channels; ++k) {
            values.col(channels[static_cast<std::size_t>(k)]) = solved.row(k).transpose();
        }
    }
    return values;
}

std::vector<int> EyeChannels::undriven() const {
    std::vector<int> left;
    for (const int eye : eyes_) {
        const bool is_driven = std::ranges::any_of(choices_, [eye](const Choice& choice) {
            return std::ranges::find(choice.eyes, eye) != choice.eyes.end();
        });
        if (!is_driven) left.push_back(eye);
    }
    return left;
}

}  // namespace mimetic
