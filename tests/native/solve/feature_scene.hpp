// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <mimetic/solve/solve.hpp>
#include <vector>

namespace mimetic::test {

/// Two eyes of two margins each and nothing else, before a camera; values: upper and lower lid of the left
/// eye, of the right eye, and a brow that carries both upper margins up. Margins are arcs from the outer
/// to the inner corner; an upper lid at 1 lies on the lower margin.
struct FeatureScene {
    static constexpr int kPoints = 9;
    static constexpr double kHalfWidth = .0145, kRise = .006,
                            kFall = .004;  // metres, of the margins' middles
    enum Value { upper_left, lower_left, upper_right, lower_right, brow, kValues };

    Camera camera{900, 900, 319.5, 239.5, 640, 480};
    TrackedSurface surface;
    FaceMotion motion;
    FeatureInputs inputs;
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();

    FeatureScene() {
        motion.neutral.resize(4 * kPoints, 3);
        motion.modes.setZero(kValues, 3 * motion.neutral.rows());
        surface.quads.resize(2 * (kPoints - 1), 4);
        for (int eye = 0; eye < 2; ++eye) {
            FeatureOpening opening;
            opening.lines.resize(2);
            opening.lid_upper = eye == 0 ? upper_left : upper_right;
            opening.lid_lower = eye == 0 ? lower_left : lower_right;
            opening.shutting = {opening.lid_upper};
            for (int i = 0; i < kPoints; ++i) {
                add_pair(eye, i, opening);
            }
            for (int i = 0; i + 1 < kPoints; ++i) {
                const int first = 2 * kPoints * eye + i;
                surface.quads.row((kPoints - 1) * eye + i) << first, first + kPoints, first + kPoints + 1,
                    first + 1;
            }
            inputs.openings.push_back(opening);
        }
        surface.stencils.resize(motion.neutral.rows(), motion.neutral.rows());
        surface.stencils.setIdentity();
        surface.weights = Eigen::VectorXd::Ones(motion.neutral.rows());
        motion.num_muscles = 0;
        motion.lower = Eigen::VectorXd::Constant(kValues, -1);
        motion.upper = Eigen::VectorXd::Ones(kValues);
        motion.prior_std = Eigen::VectorXd::Constant(kValues, .5);
        motion.prior_std[lower_left] = motion.prior_std[lower_right] = .15;
        camera_from_head.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
        camera_from_head.translation() = Eigen::Vector3d(0, 0, .6);
    }

    /// The lines as a camera sees them; raised: metres, of upper and lower margins beside the model's.
    std::vector<SeenOpening> see(const Eigen::VectorXd& values, double upper_raised = 0,
                                 double lower_raised = 0) const {
        Points moved = motion.neutral;
        Eigen::Map<Eigen::VectorXd>(moved.data(), moved.size()) += motion.modes.transpose() * values;
        std::vector<SeenOpening> seen;
        for (const FeatureOpening& opening : inputs.openings) {
            SeenOpening& one = seen.emplace_back();
            for (std::size_t line = 0; line < opening.lines.size(); ++line) {
                Points2& pixels = one.lines.emplace_back(kPoints, 2);
                for (int i = 0; i < kPoints; ++i) {
                    Eigen::Vector3d point = moved.row(opening.lines[line][static_cast<std::size_t>(i)]);
                    point.y() += line == 0 ? upper_raised : lower_raised;
                    pixels.row(i) = camera.project(camera_from_head * point).transpose();
                }
            }
        }
        return seen;
    }

private:
    void add_pair(int eye, int i, FeatureOpening& opening) {
        const double along = 2. * i / (kPoints - 1) - 1, side = eye == 0 ? 1 : -1;
        const double arch = 1 - along * along;
        for (int line = 0; line < 2; ++line) {
            const int vertex = (2 * eye + line) * kPoints + i;
            motion.neutral.row(vertex) << side * (.0315 - kHalfWidth * along),
                line == 0 ? kRise * arch : -kFall * arch, 0;
            opening.lines[static_cast<std::size_t>(line)].push_back(vertex);
            auto move = [&](Value value, double rise) { motion.modes(value, 3 * vertex + 1) = rise * arch; };
            if (line == 0) {
                move(eye == 0 ? upper_left : upper_right, -(kRise + kFall));
                move(brow, .002);
            } else {
                move(eye == 0 ? lower_left : lower_right, .003);
            }
        }
    }
};

}  // namespace mimetic::test
