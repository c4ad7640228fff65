// SPDX-License-Identifier: GPL-3.0-or-later
// Images with exactly known motion: a texture given by a formula, sampled at the moved places.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <mimetic/flow/flow.hpp>
#include <random>
#include <vector>

namespace mimetic::testing {

struct Image {
    int rows = 0;
    int cols = 0;
    std::vector<std::uint8_t> pixels;
    GrayView view() const { return {pixels.data(), rows, cols, cols}; }
};

using Texture = std::function<double(double x, double y)>;
using Motion = std::function<Eigen::Vector2d(double x, double y)>;  ///< pixels

/// Waves of random directions and lengths from 4 to 40 pixels, the short ones weak as in a camera's picture.
inline Texture make_texture(unsigned seed, double contrast) {
    struct Wave {
        double kx, ky, phase, amplitude;
    };
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Wave> waves;
    constexpr int kNumWaves = 60;
    for (int i = 0; i < kNumWaves; ++i) {
        const double length = 4 * std::pow(10.0, uniform(random));
        const double angle = 2 * M_PI * uniform(random);
        const double k = 2 * M_PI / length;
        waves.push_back({k * std::cos(angle), k * std::sin(angle), 2 * M_PI * uniform(random),
                         contrast * std::sqrt(2.0 / kNumWaves) * std::min(1.0, length / 12)});
    }
    return [waves](double x, double y) {
        double value = 128;
        for (const auto& wave : waves) {
            value += wave.amplitude * std::cos(wave.kx * x + wave.ky * y + wave.phase);
        }
        return value;
    };
}

/// The image whose pixel x + motion(x) shows the texture at x, with sensor noise.
inline Image render(const Texture& texture, const Motion& motion, int rows, int cols, double noise,
                    unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    Image image{rows, cols, {}};
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < cols; ++x) {
            Eigen::Vector2d source(x, y);
            for (int i = 0; i < 30; ++i) {  // a contraction: the motions are smooth
                source = Eigen::Vector2d(x, y) - motion(source.x(), source.y());
            }
            const double value = texture(source.x(), source.y()) + noise * normal(random);
            image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0)));
        }
    }
    return image;
}

inline Eigen::Vector2d still(double, double) { return {0, 0}; }

}  // namespace mimetic::testing
