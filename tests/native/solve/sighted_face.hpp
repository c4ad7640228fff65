// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <mimetic/solve/sightings.hpp>
#include <random>
#include <vector>

namespace mimetic::test {

/// A bulging patch of skin, the size of a face, of which points are seen as a camera shows them.
struct SightedFace {
    static constexpr int kSide = 12;  // quads
    Camera camera{700, 700, 319.5, 239.5, 640, 480};
    Quads quads{kSide * kSide, 4};
    Points neutral{(kSide + 1) * (kSide + 1), 3};
    Eigen::Isometry3d reference = Eigen::Isometry3d::Identity();

    SightedFace() {
        for (int j = 0; j <= kSide; ++j) {
            for (int i = 0; i <= kSide; ++i) {
                const double x = .14 * (double(i) / kSide - .5), y = .18 * (double(j) / kSide - .5);
                neutral.row(j * (kSide + 1) + i) << x, y, .09 - 6 * (x * x + y * y);
            }
        }
        for (int j = 0; j < kSide; ++j) {
            for (int i = 0; i < kSide; ++i) {
                const int at = j * (kSide + 1) + i;
                quads.row(j * kSide + i) << at, at + 1, at + kSide + 2, at + kSide + 1;
            }
        }
        reference.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
        reference.translation() = Eigen::Vector3d(0, 0, .6);
    }

    FittedSkin skin() const {
        return {SubdividedMesh(quads, int(neutral.rows()), 1), neutral, camera, reference};
    }

    Eigen::Isometry3d turned(double yaw) const {
        Eigen::Isometry3d pose = reference;
        pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()));
        return pose;
    }

    /// One smooth bump across the patch a row: C x 3S metres.
    MatrixRows bumps(double metres) const {
        MatrixRows modes(4, neutral.size());
        modes.setZero();
        for (Eigen::Index v = 0; v < neutral.rows(); ++v) {
            for (int m = 0; m < 4; ++m) {
                const Eigen::Vector2d middle(.035 * (m % 2 ? 1 : -1), .045 * (m / 2 ? 1 : -1));
                const double away = (neutral.row(v).head<2>().transpose() - middle).squaredNorm();
                modes(m, 3 * v + 2) = metres * std::exp(-away / (2 * .03 * .03));
            }
        }
        return modes;
    }

    /// Of a face whose skin differs by `change` (S x 3, metres); the fitted one's points are named.
    /// slip: pixels to the right by which the middle of the face is seen beside its place in every frame.
    Sighting sighting(int frame, const Eigen::Isometry3d& pose, const Points& change, double slip = 0,
                      const Eigen::VectorXd& values = Eigen::VectorXd::Zero(1)) const {
        const Points moved = skin().stencils * (neutral + change);
        std::mt19937 random(static_cast<unsigned>(frame));
        std::normal_distribution<double> noise(0, .1);
        Sighting one{frame, pose, values, {}, {}, {}, {}, 0};
        const Quads refined = SubdividedMesh(quads, int(neutral.rows()), 1).faces();
        const Eigen::Index count = refined.rows() / 2;
        one.vertices.resize(count, 3);
        one.barycentric = Points::Constant(count, 3, 1. / 3);
        one.pixels.resize(count, 2);
        one.information.resize(count, 4);
        for (Eigen::Index k = 0; k < count; ++k) {
            one.vertices.row(k) = refined.row(2 * k).head<3>();
            Eigen::Vector3d place = Eigen::Vector3d::Zero();
            for (const int vertex : one.vertices.row(k)) {
                place += moved.row(vertex).transpose() / 3;
            }
            const Eigen::Vector2d pixel = camera.project(pose * place);
            const double beside = slip * std::exp(-place.head<2>().squaredNorm() / (2 * .03 * .03));
            one.pixels.row(k) << pixel.x() + noise(random) + beside, pixel.y() + noise(random);
            one.information.row(k) << 100, 0, 0, 100;
        }
        return one;
    }
};

}  // namespace mimetic::test
