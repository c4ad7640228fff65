// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mimetic/locate/feature_networks.hpp>
#include <mimetic/shared/error.hpp>
#include <random>

namespace mimetic {
namespace {

const Camera kCamera{800, 800, 319.5, 239.5, 640, 480};

/// A head that faces the camera from a metre's distance, then rolls clockwise in the picture.
Eigen::Isometry3d facing(double roll) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
                    Eigen::Vector3d(1, -1, -1).asDiagonal();
    pose.translation() = Eigen::Vector3d(0.1, -0.05, 1);
    return pose;
}

Points anchors() {
    Points points(6, 3);
    points << 0, 0.1, 0.08, 0, -0.1, 0.08, 0.045, 0.03, 0.07, 0.018, 0.03, 0.08, -0.045, 0.03, 0.07, -0.018,
        0.03, 0.08;
    return points;
}

TEST(FeatureCrops, LieRoundTheirPointsAndTurnWithTheHead) {
    for (const double roll : {0.0, 0.4, -0.7}) {
        const Eigen::Isometry3d pose = facing(roll);
        const FeatureCrop crop = crop_round(kCamera, pose, {0.02, 0.03, 0}, 0.05);
        EXPECT_LT((crop.center - kCamera.project(pose * Eigen::Vector3d(0.02, 0.03, 0))).norm(), 1e-9);
        EXPECT_NEAR(crop.roll, roll, 1e-9);
        EXPECT_NEAR(crop.side, 0.05 * 800, 1e-9);
    }
}

TEST(FeatureCrops, GrowAsTheHeadComesNearer) {
    Eigen::Isometry3d near = facing(0);
    near.translation().z() = 0.5;
    const FeatureCrops far_crops = feature_crops(kCamera, facing(0), anchors());
    const FeatureCrops near_crops = feature_crops(kCamera, near, anchors());
    EXPECT_GT(near_crops.face.side, 1.9 * far_crops.face.side);
    EXPECT_GT(near_crops.eyes[0].side, 1.9 * far_crops.eyes[0].side);
    EXPECT_GT(far_crops.eyes[0].center.x(), far_crops.eyes[1].center.x());  // the left eye, at the right
}

TEST(FeatureCrops, RefuseAHeadBehindTheCameraAndWrongAnchors) {
    Eigen::Isometry3d behind = facing(0);
    behind.translation().z() = -1;
    EXPECT_THROW(crop_round(kCamera, behind, Eigen::Vector3d::Zero(), 0.1), InvalidInput);
    EXPECT_THROW(feature_crops(kCamera, facing(0), anchors().topRows(5)), InvalidInput);
    EXPECT_THROW((FeatureCrop{{10, 10}, 0.5, 0}.check()), InvalidInput);
    EXPECT_THROW((FeatureCrop{{10, NAN}, 50, 0}.check()), InvalidInput);
}

/// A file of a test's own, gone after it.
struct Scratch {
    std::filesystem::path path;
    explicit Scratch(const std::string& content)
        : path(std::filesystem::temp_directory_path() /
               ("mimetic_network_" + std::to_string(std::random_device{}()) + ".onnx")) {
        std::ofstream(path, std::ios::binary) << content;
    }
    ~Scratch() { std::filesystem::remove(path); }
};

TEST(FeatureNetworks, RefuseFilesThatAreNoNetworks) {
    EXPECT_THROW(FeatureNetworks("/nowhere/mesh.onnx", "/nowhere/iris.onnx"), UnreadableMedia);
    EXPECT_THROW(FeatureNetworks("/dev/zero", "/dev/zero"), UnreadableMedia);
    for (const std::string& content :
         {std::string(), std::string("no network"), std::string(100000, '\x0a')}) {
        const Scratch file(content);
        EXPECT_THROW(FeatureNetworks(file.path.string(), file.path.string()), UnreadableMedia);
    }
    const Scratch large("");
    std::filesystem::resize_file(large.path, std::uintmax_t{1} << 33);  // sparse
    EXPECT_THROW(FeatureNetworks(large.path.string(), large.path.string()), UnreadableMedia);
}

}  // namespace
}  // namespace mimetic
