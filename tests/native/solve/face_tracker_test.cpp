// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <mimetic/error.hpp>

#include "face_scene.hpp"

namespace mimetic {
namespace {

using test::degrees_between;
using test::FaceScene;

const FaceScene& scene() {
    static const FaceScene made;
    return made;
}

/// A run of frames with its truth.
struct Clip {
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Eigen::VectorXd> values;
};

double ramp(int frame, int start, int end) {
    return std::clamp(static_cast<double>(frame - start) / (end - start), 0., 1.);
}

/// Two brows rise, a smile follows, the jaw drops; the head nods and turns meanwhile.
Clip expressive_clip(int num_frames) {
    Clip clip;
    for (int t = 0; t < num_frames; ++t) {
        Eigen::VectorXd values = scene().rest();
        values[0] = .8 * ramp(t, 4, 12) * (1 - ramp(t, 24, 32));
        values[1] = .6 * ramp(t, 4, 12) * (1 - ramp(t, 24, 32));
        values[2] = .7 * ramp(t, 14, 22);
        values[3] = .7 * ramp(t, 14, 22);
        values[5] = .9 * ramp(t, 26, 34);
        Eigen::Isometry3d pose = scene().camera_from_head;
        pose.linear() = (Eigen::AngleAxisd(.12 * std::sin(.2 * t), Eigen::Vector3d::UnitX()) *
                         Eigen::AngleAxisd(.2 * std::sin(.13 * t), Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(.05 * std::sin(.1 * t), Eigen::Vector3d::UnitZ()))
                            .toRotationMatrix() *
                        pose.linear();
        pose.translation() +=
            Eigen::Vector3d(.01 * std::sin(.15 * t), .008 * std::sin(.1 * t), .03 * std::sin(.07 * t));
        clip.poses.push_back(pose);
        clip.values.push_back(values);
    }
    return clip;
}

FaceTracker make_tracker(const TrackerOptions& options = {}) {
    const auto image = scene().render(scene().camera_from_head, scene().rest());
    return {
        scene().camera, scene().surface, scene().motion, scene().view(image), scene().camera_from_head, {},
        options};
}

TEST(FaceTracker, RecoversPoseAndValuesThroughExpressionsAndHeadMotion) {
    const Clip clip = expressive_clip(40);
    FaceTracker tracker = make_tracker();
    double worst_turn = 0, sum = 0;
    int count = 0;
    for (std::size_t t = 1; t < clip.poses.size(); ++t) {
        const auto image =
            scene().render(clip.poses[t], clip.values[t], 2, 1, 0, static_cast<unsigned>(t + 7));
        const FrameEstimate estimate = tracker.advance(scene().view(image));
        const Eigen::VectorXd error = (estimate.values - clip.values[t]).head(6);
        worst_turn = std::max(worst_turn, degrees_between(estimate.camera_from_head, clip.poses[t]));
        sum += error.squaredNorm();
        count += 6;
        if (std::getenv("SHOW")) {
            std::cerr
                << t << " q " << estimate.quality << " ncc " << estimate.correlation << " res "
                << estimate.residual_px << " deg "
                << degrees_between(estimate.camera_from_head, clip.poses[t]) << " mm "
                << 1e3 * (estimate.camera_from_head.translation() - clip.poses[t].translation()).transpose()
                << " v " << estimate.values.transpose() << " | " << clip.values[t].transpose() << " std "
                << estimate.values_std().transpose() << " ms " << estimate.times.predict_ms << ' '
                << estimate.times.warp_ms << ' ' << estimate.times.flow_ms << ' ' << estimate.times.solve_ms
                << ' ' << estimate.times.total_ms << " n " << estimate.num_samples << '\n';
        }
        EXPECT_GT(estimate.quality, .6) << "frame " << t;
        EXPECT_LT(error.cwiseAbs().maxCoeff(), .12) << "frame " << t;
    }
    EXPECT_LT(worst_turn, .5);
    EXPECT_LT(std::sqrt(sum / count), .03);
}

}  // namespace
}  // namespace mimetic
