// SPDX-License-Identifier: GPL-3.0-or-later
#include "correlate.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace mimetic::puppet {

namespace {

constexpr int kLanes = 8;          // of 16 bits, multiplied at once
constexpr int kAtOnce = 4;         // neighbouring windows, which share the template's loads
constexpr double kFlatStd = 0.25;  // grey levels below which a window shows nothing

using Lanes = std::int16_t __attribute__((vector_size(16)));
using Sums = std::int32_t __attribute__((vector_size(16)));

Lanes load(const std::int16_t* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

/// Sums of the products of neighbours.
Sums multiply_pairs(Lanes a, Lanes b) {
#if defined(__SSE2__)
    return reinterpret_cast<Sums>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
    Sums sums;
    for (int i = 0; i < 4; ++i) {
        sums[i] = a[2 * i] * b[2 * i] + a[2 * i + 1] * b[2 * i + 1];
    }
    return sums;
#endif
}

std::int64_t total(Sums sums) { return std::int64_t{sums[0]} + sums[1] + sums[2] + sums[3]; }

/// Sums of products of the template with kAtOnce windows from `from` on.
std::array<std::int64_t, kAtOnce> products(const Kernel& kernel, const std::int16_t* from,
                                           std::ptrdiff_t stride) {
    Sums a{}, b{}, c{}, d{};
    const std::int16_t* row = kernel.values.data();
    for (int y = 0; y < kernel.rows; ++y, from += stride, row += kernel.width) {
        for (int x = 0; x < kernel.width; x += kLanes) {
            const Lanes own = load(row + x);
            a += multiply_pairs(own, load(from + x));
            b += multiply_pairs(own, load(from + x + 1));
            c += multiply_pairs(own, load(from + x + 2));
            d += multiply_pairs(own, load(from + x + 3));
        }
    }
    return {total(a), total(b), total(c), total(d)};
}

}  // namespace

Kernel::Kernel(const std::uint8_t* pixels, int num_rows, int num_cols)
    : rows(num_rows), cols(num_cols), width((num_cols + kLanes - 1) / kLanes * kLanes) {
    values.assign(static_cast<std::size_t>(rows * width), 0);
    double squares = 0;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < cols; ++x) {
            const std::uint8_t value = pixels[y * cols + x];
            values[static_cast<std::size_t>(y * width + x)] = value;
            sum += value;
            squares += value * value;
        }
    }
    spread = std::sqrt(std::max(0., squares - sum * sum / (rows * cols)));
}

Eigen::MatrixXf correlate(const ImageLevel& level, const Kernel& kernel, const Window& window) {
    const int num_cols = window.x1 - window.x0, num_rows = window.y1 - window.y0;
    if (!level.covers(window, kernel.rows, kernel.cols)) {
        throw std::logic_error("windows of a template without sums");
    }
    Eigen::MatrixXf scores(num_rows, num_cols);
    const double count = kernel.rows * kernel.cols;
    const double flat = kFlatStd * std::sqrt(count);
    for (int y = 0; y < num_rows; ++y) {
        for (int x = 0; x < num_cols; x += kAtOnce) {
            const int at_x = window.x0 + x, at_y = window.y0 + y;
            const auto sums = products(kernel, level.row(at_y) + at_x, level.stride());
            for (int i = 0; i < std::min(kAtOnce, num_cols - x); ++i) {
                const double sum = level.sum_of(at_x + i, at_y, kernel.rows, kernel.cols);
                const double squares = level.squares_of(at_x + i, at_y, kernel.rows, kernel.cols);
                const double spread = std::sqrt(std::max(0., squares - sum * sum / count));
                const double shared =
                    static_cast<double>(sums[static_cast<std::size_t>(i)]) - sum * kernel.sum / count;
                const bool is_flat = spread < flat || kernel.spread < flat;
                scores(y, x + i) = is_flat ? 0.F : static_cast<float>(shared / (spread * kernel.spread));
            }
        }
    }
    return scores;
}

}  // namespace mimetic::puppet
