// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/passing_cover.hpp>
#include <mimetic/shared/error.hpp>

#include "shared/robust.hpp"

namespace mimetic {

namespace {

constexpr double kPassing = .25;  // of the frames, at least, have nothing at the place of what passes
constexpr double kThere = .5;     // probability

bool is_usual(const std::vector<Occlusion>& frames, const Eigen::Vector2d& pixel) {
    std::vector<double> probabilities;
    probabilities.reserve(frames.size());
    for (const Occlusion& frame : frames) {
        probabilities.push_back(frame.at(pixel));
    }
    return quantile(probabilities, kPassing) >= kThere;
}

}  // namespace

Eigen::VectorXd passing_shares(const std::vector<Occlusion>& frames) {
    Eigen::VectorXd shares(static_cast<Eigen::Index>(frames.size()));
    std::transform(frames.begin(), frames.end(), shares.begin(), [&](Occlusion frame) {
        if (frame.cells.size() == 0) {
            throw InvalidInput("what is before the face must have been looked for in each frame");
        }
        for (Eigen::Index row = 0; row < frame.cells.rows(); ++row) {
            for (Eigen::Index column = 0; column < frame.cells.cols(); ++column) {
                float& cell = frame.cells(row, column);
                if (cell > Occlusion::kSure &&
                    is_usual(frames, frame.pixel_of(static_cast<double>(row), static_cast<double>(column)))) {
                    cell = 0;
                }
            }
        }
        return frame.sure_share();
    });
    return shares;
}

}  // namespace mimetic
