// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/head/head.hpp>
#include <random>
#include <vector>

namespace mimetic::test {

/// A textured head before a textured wall, drawn by its own renderer: an ellipsoid, or one with a nose,
/// sockets, chin, ears and hair, which no ellipsoid is.
class HeadScene {
public:
    static constexpr int kAround = 64;
    static constexpr int kUp = 48;
    Camera camera{380, 380, 159.5, 119.5, 320, 240};
    const Eigen::Vector3d half_axes{.075, .11, .095};
    Points vertices;
    Quads faces;
    double alike = 1;  ///< correlation of this head's skin with the usual one's

    explicit HeadScene(bool is_ellipsoid) {
        vertices.resize(kAround * (kUp + 1), 3);
        for (int j = 0; j <= kUp; ++j) {
            for (int i = 0; i < kAround; ++i) {
                const double around = 2 * M_PI * i / kAround, up = M_PI * (double(j) / kUp - .5);
                const Eigen::Vector3d on_sphere(std::sin(around) * std::cos(up), std::sin(up),
                                                std::cos(around) * std::cos(up));
                const Eigen::Vector3d place = on_sphere.cwiseProduct(half_axes);
                const Eigen::Vector3d outwards = on_sphere.cwiseQuotient(half_axes).normalized();
                vertices.row(j * kAround + i) =
                    (place + (is_ellipsoid ? 0 : relief(place)) * outwards).transpose();
            }
        }
        faces.resize(kAround * kUp, 4);
        for (int j = 0; j < kUp; ++j) {
            for (int i = 0; i < kAround; ++i) {
                const int next = (i + 1) % kAround;
                faces.row(j * kAround + i) << j * kAround + i, j * kAround + next, (j + 1) * kAround + next,
                    (j + 1) * kAround + i;
            }
        }
    }

    /// Facing the camera at 60 cm, then turned about the head's axes (degrees) and moved (metres).
    static Eigen::Isometry3d pose(double yaw, double pitch, double roll, double x = 0, double y = 0,
                                  double z = 0) {
        constexpr double kDegree = M_PI / 180;
        Eigen::Isometry3d camera_from_head = Eigen::Isometry3d::Identity();
        camera_from_head.translation() = Eigen::Vector3d(x, y, .6 + z);
        camera_from_head.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
        camera_from_head.rotate(Eigen::AngleAxisd(roll * kDegree, Eigen::Vector3d::UnitZ()));
        camera_from_head.rotate(Eigen::AngleAxisd(yaw * kDegree, Eigen::Vector3d::UnitY()));
        camera_from_head.rotate(Eigen::AngleAxisd(pitch * kDegree, Eigen::Vector3d::UnitX()));
        return camera_from_head;
    }

    /// A head that looks round at 30 frames a second: yaw to 35, pitch to 15, roll to 12 degrees.
    static Eigen::Isometry3d motion(int frame) {
        const double t = frame / 30.;
        return pose(35 * std::sin(1.3 * t), 15 * std::sin(1.9 * t), 12 * std::sin(.9 * t),
                    .03 * std::sin(.7 * t), .02 * std::sin(1.1 * t), .05 * std::sin(.8 * t));
    }

    /// RGB with two grey levels of noise; gain: of the light; hand: the left half is covered.
    std::vector<std::uint8_t> render(const Eigen::Isometry3d& pose, unsigned seed = 1, double gain = 1,
                                     bool hand = false) const {
        const int num_pixels = camera.width * camera.height;
        std::vector<float> depth(static_cast<std::size_t>(num_pixels), 1e9F);
        std::vector<float> shade(static_cast<std::size_t>(num_pixels));
        for (int k = 0; k < num_pixels; ++k) {
            const double x = k % camera.width, y = k / camera.width;
            shade[static_cast<std::size_t>(k)] = static_cast<float>(
                110 + 40 * std::sin(.11 * x + 2 * std::sin(.05 * y)) * std::sin(.09 * y + 1));
        }
        const Points moved =
            (vertices * pose.linear().transpose()).rowwise() + pose.translation().transpose();
        std::vector<Eigen::Vector3f> corners;
        for (Eigen::Index v = 0; v < moved.rows(); ++v) {
            const Eigen::Vector3d point = moved.row(v);
            const Eigen::Vector2d pixel = camera.project(point);
            corners.emplace_back(Eigen::Vector3d(pixel.x(), pixel.y(), 1 / point.z()).cast<float>());
        }
        for (Eigen::Index f = 0; f < faces.rows(); ++f) {
            draw({faces(f, 0), faces(f, 1), faces(f, 2)}, corners, shade, depth);
            draw({faces(f, 0), faces(f, 2), faces(f, 3)}, corners, shade, depth);
        }
        std::minstd_rand random(seed);
        std::vector<std::uint8_t> image(static_cast<std::size_t>(3 * num_pixels));
        for (int k = 0; k < num_pixels; ++k) {
            const double noise = double(random() % 1024 + random() % 1024 + random() % 1024) / 1024 - 1.5;
            const bool covered = hand && k % camera.width < camera.width / 2 + 6;
            const double grey = covered ? 150 : gain * double(shade[static_cast<std::size_t>(k)]);
            for (int c = 0; c < 3; ++c) {
                image[static_cast<std::size_t>(3 * k + c)] =
                    static_cast<std::uint8_t>(std::clamp(grey + 4 * noise, 0., 255.));
            }
        }
        return image;
    }

    ColorView view(const std::vector<std::uint8_t>& image) const {
        return {image.data(), camera.height, camera.width, 3 * camera.width};
    }

private:
    static double bump(const Eigen::Vector3d& place, double x, double y, double z, double radius) {
        return std::exp(-.5 * (place - Eigen::Vector3d(x, y, z)).squaredNorm() / (radius * radius));
    }

    static double relief(const Eigen::Vector3d& p) {
        double height = .022 * bump(p, 0, -.01, .095, .012) + .006 * bump(p, 0, -.085, .06, .02);
        for (const double side : {-1., 1.}) {
            height += -.008 * bump(p, side * .032, .02, .085, .014) + .012 * bump(p, side * .075, 0, 0, .014);
        }
        return height + (p.y() > .05 ? .01 * std::sin(60 * p.x()) * (p.y() - .05) / .06 : 0);
    }

    /// Solid, so that it needs no unfolding.
    float albedo(const Eigen::Vector3d& p) const {
        const double own = waves(p), other = alike == 1 ? 0 : waves({p.y() + .3, -p.x(), p.z()});
        return static_cast<float>(130 + 16 * (alike * own + std::sqrt(1 - alike * alike) * other));
    }

    struct Wave {
        Eigen::Vector3d vector;  ///< radians a metre
        double phase;
    };

    static std::array<Wave, 9> make_waves() {
        std::array<Wave, 9> made;
        for (int k = 1; k <= 9; ++k) {
            const Eigen::Vector3d direction(std::cos(2.4 * k), std::sin(2.4 * k), std::cos(1.1 * k));
            made[static_cast<std::size_t>(k - 1)] = {6.28 / (.009 + .004 * k) * direction, 1.7 * k * k};
        }
        return made;
    }

    static double waves(const Eigen::Vector3d& p) {
        static const std::array<Wave, 9> made = make_waves();
        double sum = 0;
        for (const Wave& wave : made) {
            sum += std::sin(wave.vector.dot(p) + wave.phase);
        }
        return sum;
    }

    void draw(const std::array<int, 3>& corner, const std::vector<Eigen::Vector3f>& corners,
              std::vector<float>& shade, std::vector<float>& depth) const {
        const Eigen::Vector3f& a = corners[static_cast<std::size_t>(corner[0])];
        const Eigen::Vector3f e1 = corners[static_cast<std::size_t>(corner[1])] - a;
        const Eigen::Vector3f e2 = corners[static_cast<std::size_t>(corner[2])] - a;
        const float area = e1.x() * e2.y() - e1.y() * e2.x();
        if (area > -1e-6F) {
            return;
        }
        const int x0 = std::max(0, static_cast<int>(std::ceil(a.x() + std::min({0.F, e1.x(), e2.x()}))));
        const int y0 = std::max(0, static_cast<int>(std::ceil(a.y() + std::min({0.F, e1.y(), e2.y()}))));
        const int x1 = std::min(camera.width - 1, static_cast<int>(a.x() + std::max({0.F, e1.x(), e2.x()})));
        const int y1 = std::min(camera.height - 1, static_cast<int>(a.y() + std::max({0.F, e1.y(), e2.y()})));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const float dx = float(x) - a.x(), dy = float(y) - a.y();
                const float w1 = (dx * e2.y() - dy * e2.x()) / area;
                const float w2 = (e1.x() * dy - e1.y() * dx) / area;
                const float inverse = a.z() + w1 * e1.z() + w2 * e2.z();
                const auto index = static_cast<std::size_t>(y * camera.width + x);
                if (w1 >= 0 && w2 >= 0 && w1 + w2 <= 1 && 1 / inverse < depth[index]) {
                    depth[index] = 1 / inverse;
                    const std::array<float, 3> w{(1 - w1 - w2) * a.z() / inverse,
                                                 w1 * (a.z() + e1.z()) / inverse,
                                                 w2 * (a.z() + e2.z()) / inverse};
                    Eigen::Vector3d place = Eigen::Vector3d::Zero();
                    for (std::size_t k = 0; k < 3; ++k) {
                        place += double(w[k]) * vertices.row(corner[k]).transpose();
                    }
                    shade[index] = albedo(place);
                }
            }
        }
    }
};

inline double degrees_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / M_PI;
}

}  // namespace mimetic::test
