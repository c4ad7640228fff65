// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <mimetic/solve/solve.hpp>
#include <random>
#include <vector>

namespace mimetic::test {

/// A textured half ellipsoid, the size of a face, that bulges and slides by smooth modes; drawn by its own
/// renderer.
class FaceScene {
public:
    static constexpr int kAcross = 28;
    static constexpr int kAlong = 36;
    Camera camera{600, 600, 159.5, 119.5, 320, 240};
    double person = 0;  ///< whose skin: another number, another pattern

    FaceScene() {
        const int num_vertices = (kAcross + 1) * (kAlong + 1);
        motion.neutral.resize(num_vertices, 3);
        for (int j = 0; j <= kAlong; ++j) {
            for (int i = 0; i <= kAcross; ++i) {
                motion.neutral.row(vertex(i, j)) = place(i, j).transpose();
            }
        }
        surface.quads.resize(kAcross * kAlong, 4);
        for (int j = 0; j < kAlong; ++j) {
            for (int i = 0; i < kAcross; ++i) {
                surface.quads.row(j * kAcross + i) << vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1),
                    vertex(i + 1, j);
            }
        }
        surface.stencils.resize(num_vertices, num_vertices);
        surface.stencils.setIdentity();
        surface.weights = Eigen::VectorXd::Ones(num_vertices);
        add_modes();
        camera_from_head.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
        camera_from_head.translation() = Eigen::Vector3d(0, 0, .65);
    }

    /// RGB of the face in a state; gain and offset of light, grey levels of noise.
    std::vector<std::uint8_t> render(const Eigen::Isometry3d& pose, const Eigen::VectorXd& values,
                                     double noise = 2, double gain = 1, double offset = 0,
                                     unsigned seed = 1) const {
        constexpr int kFiner = 2;
        const int rows = camera.height * kFiner, cols = camera.width * kFiner;
        std::vector<double> shade(static_cast<std::size_t>(rows * cols), 60);
        std::vector<double> depth(shade.size(), 1e9);
        Points moved = motion.neutral;
        for (int m = 0; m < values.size(); ++m) {
            moved += values[m] * Eigen::Map<const Points>(motion.modes.row(m).data(), moved.rows(), 3);
        }
        for (Eigen::Index f = 0; f < surface.quads.rows(); ++f) {
            const auto quad = surface.quads.row(f);
            draw_triangle({quad[0], quad[1], quad[2]}, pose, moved, kFiner, cols, rows, shade, depth);
            draw_triangle({quad[0], quad[2], quad[3]}, pose, moved, kFiner, cols, rows, shade, depth);
        }
        std::mt19937 random(seed);
        std::normal_distribution<double> normal(0, noise);
        std::vector<std::uint8_t> image(static_cast<std::size_t>(3 * camera.width * camera.height));
        for (int y = 0; y < camera.height; ++y) {
            for (int x = 0; x < camera.width; ++x) {
                double sum = 0;
                for (int k = 0; k < kFiner * kFiner; ++k) {
                    sum += shade[static_cast<std::size_t>((y * kFiner + k / kFiner) * cols + x * kFiner +
                                                          k % kFiner)];
                }
                const double grey = gain * sum / (kFiner * kFiner) + offset + normal(random);
                for (int c = 0; c < 3; ++c) {
                    image[static_cast<std::size_t>(3 * (y * camera.width + x) + c)] =
                        static_cast<std::uint8_t>(std::clamp(grey, 0., 255.));
                }
            }
        }
        return image;
    }

    ColorView view(const std::vector<std::uint8_t>& image) const {
        return {image.data(), camera.height, camera.width, 3 * camera.width};
    }

    Eigen::VectorXd rest() const { return Eigen::VectorXd::Zero(motion.lower.size()); }

    TrackedSurface surface;
    FaceMotion motion;
    Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();

private:
    static int vertex(int i, int j) { return j * (kAcross + 1) + i; }

    static Eigen::Vector3d place(int i, int j) {
        const double across = (static_cast<double>(i) / kAcross - .5) * 2.6;
        const double down = (static_cast<double>(j) / kAlong - .5) * 2.2;
        return {.075 * std::sin(across) * std::cos(.6 * down), -.11 * std::sin(down),
                .09 * std::cos(across) * std::cos(down)};
    }

    void add_modes() {
        struct Bump {
            double x, y, radius;
            Eigen::Vector3d pull;
        };
        const std::vector<Bump> bumps{
            {-.03, .05, .025, {0, .012, 0}},      {.03, .05, .025, {0, .012, 0}},
            {-.03, -.05, .022, {-.006, .008, 0}}, {.03, -.05, .022, {.006, .008, 0}},
            {0, .02, .02, {0, -.008, 0}},         {0, -.08, .035, {0, -.02, -.004}},
            {0, -.05, .02, {0, 0, .008}}};
        const auto count = static_cast<Eigen::Index>(bumps.size());
        motion.modes.setZero(count, 3 * motion.neutral.rows());
        for (Eigen::Index m = 0; m < count; ++m) {
            const Bump& bump = bumps[static_cast<std::size_t>(m)];
            for (Eigen::Index v = 0; v < motion.neutral.rows(); ++v) {
                const double distance =
                    std::hypot(motion.neutral(v, 0) - bump.x, motion.neutral(v, 1) - bump.y);
                motion.modes.row(m).segment<3>(3 * v) =
                    std::exp(-.5 * std::pow(distance / bump.radius, 2)) * bump.pull.transpose();
            }
        }
        motion.num_muscles = 5;
        motion.lower = Eigen::VectorXd::Zero(count);
        motion.upper = Eigen::VectorXd::Ones(count);
        motion.prior_std = Eigen::VectorXd::Constant(count, .3);
        motion.prior_std[6] = .1;
    }

    /// Grey of the skin at parameters (across, down) in [0, 1].
    double albedo(double a, double b) const {
        const double x = 150 * a, y = 200 * b;  // about millimetres
        double sum = 0;
        for (int k = 1; k <= 14; ++k) {
            const double angle = 2.4 * k, wave = 6.28 / (5 + 2.6 * k);
            sum += std::sin(wave * (std::cos(angle) * x + std::sin(angle) * y) + (1.7 + person) * k * k);
        }
        return 130 + 14 * sum;
    }

    void draw_triangle(const std::array<int, 3>& corners, const Eigen::Isometry3d& pose, const Points& moved,
                       int finer, int cols, int rows, std::vector<double>& shade,
                       std::vector<double>& depth) const {
        Eigen::Vector2d pixel[3];
        double z[3], a[3], b[3];
        for (int k = 0; k < 3; ++k) {
            const int v = corners[static_cast<std::size_t>(k)];
            const Eigen::Vector3d point = pose * Eigen::Vector3d(moved.row(v));
            z[k] = point.z();
            // Pixel (0, 0) is a pixel's centre in both resolutions.
            pixel[k] = (camera.project(point) + Eigen::Vector2d::Constant(.5)) * finer -
                       Eigen::Vector2d::Constant(.5);
            a[k] = static_cast<double>(v % (kAcross + 1)) / kAcross;
            b[k] = static_cast<double>(v / (kAcross + 1)) / kAlong;
        }
        const Eigen::Vector2d e1 = pixel[1] - pixel[0], e2 = pixel[2] - pixel[0];
        const double area = e1.x() * e2.y() - e1.y() * e2.x();
        if (area >= -1e-9) {
            return;
        }
        const int x0 =
            std::max(0, static_cast<int>(std::ceil(std::min({pixel[0].x(), pixel[1].x(), pixel[2].x()}))));
        const int x1 =
            std::min(cols - 1, static_cast<int>(std::max({pixel[0].x(), pixel[1].x(), pixel[2].x()})));
        const int y0 =
            std::max(0, static_cast<int>(std::ceil(std::min({pixel[0].y(), pixel[1].y(), pixel[2].y()}))));
        const int y1 =
            std::min(rows - 1, static_cast<int>(std::max({pixel[0].y(), pixel[1].y(), pixel[2].y()})));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const Eigen::Vector2d d = Eigen::Vector2d(x, y) - pixel[0];
                const double w1 = (d.x() * e2.y() - d.y() * e2.x()) / area;
                const double w2 = (e1.x() * d.y() - e1.y() * d.x()) / area;
                const double w0 = 1 - w1 - w2;
                if (std::min({w0, w1, w2}) < 0) {
                    continue;
                }
                const double inverse = w0 / z[0] + w1 / z[1] + w2 / z[2];
                const auto index = static_cast<std::size_t>(y * cols + x);
                if (1 / inverse < depth[index]) {
                    depth[index] = 1 / inverse;
                    shade[index] = albedo((w0 * a[0] / z[0] + w1 * a[1] / z[1] + w2 * a[2] / z[2]) / inverse,
                                          (w0 * b[0] / z[0] + w1 * b[1] / z[1] + w2 * b[2] / z[2]) / inverse);
                }
            }
        }
    }
};

inline double degrees_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / M_PI;
}

}  // namespace mimetic::test
