// SPDX-License-Identifier: GPL-3.0-or-later
#include "flow/rows.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

// One binary runs everywhere and still uses wide registers where they exist. The address sanitizer is not up
// yet when the loader picks the variant.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define MIMETIC_WIDE __attribute__((target_clones("arch=haswell", "default")))
#else
#define MIMETIC_WIDE
#endif

namespace mimetic::flow {

MIMETIC_WIDE void warp_row(const float* __restrict to, int rows, int cols, int y,
                           const float* __restrict at_x, const float* __restrict at_y,
                           const float* __restrict from, float* __restrict difference,
                           float* __restrict inside) {
    const auto last_x = static_cast<float>(cols - 1);
    const auto last_y = static_cast<float>(rows - 1);
    for (int x = 0; x < cols; ++x) {
        const float px = static_cast<float>(x) + at_x[x];
        const float py = static_cast<float>(y) + at_y[x];
        const bool is_inside = (px >= 0) & (px <= last_x) & (py >= 0) & (py <= last_y);
        const float cx = is_inside ? px : 0.0f;
        const float cy = is_inside ? py : 0.0f;
        const int ix = std::min(static_cast<int>(cx), cols - 2);
        const int iy = std::min(static_cast<int>(cy), rows - 2);
        const float fx = cx - static_cast<float>(ix);
        const float fy = cy - static_cast<float>(iy);
        const int at = iy * cols + ix;
        const float top = to[at] + fx * (to[at + 1] - to[at]);
        const float bottom = to[at + cols] + fx * (to[at + cols + 1] - to[at + cols]);
        inside[x] = is_inside ? 1.0f : 0.0f;
        difference[x] = top + fy * (bottom - top) - from[x];
    }
}

namespace {

MIMETIC_WIDE void multiply_row(int cols, const float* __restrict gx, const float* __restrict gy,
                               const float* __restrict weight, const float* __restrict difference,
                               const float* __restrict inside, const float* __restrict shift_x,
                               const float* __restrict shift_y, float* __restrict xx, float* __restrict xy,
                               float* __restrict yy, float* __restrict xt, float* __restrict yt,
                               float* __restrict tt) {
    for (int x = 0; x < cols; ++x) {
        const float w = weight[x] * inside[x];
        const float change = difference[x] - gx[x] * shift_x[x] - gy[x] * shift_y[x];
        const float wx = w * gx[x];
        const float wy = w * gy[x];
        xx[x] = wx * gx[x];
        xy[x] = wx * gy[x];
        yy[x] = wy * gy[x];
        xt[x] = wx * change;
        yt[x] = wy * change;
        tt[x] = w * change * change;
    }
}

MIMETIC_WIDE void subtract_row(int cols, const float* __restrict a, const float* __restrict b,
                               float* __restrict out) {
    for (int x = 0; x < cols; ++x) {
        out[x] = a[x] - b[x];
    }
}

// Gaussian of 2 pixels' standard deviation: wide enough to beat a webcam's noise on skin, narrow beside a
// lip.
constexpr float kTaps[kReach + 1] = {0.204164f, 0.180174f, 0.123832f, 0.066282f, 0.027631f};

MIMETIC_WIDE void blur_rows(int cols, const float* const* rows, std::ptrdiff_t at, float* __restrict out) {
    const float* __restrict r0 = rows[0] + at;
    const float* __restrict r1 = rows[1] + at;
    const float* __restrict r2 = rows[2] + at;
    const float* __restrict r3 = rows[3] + at;
    const float* __restrict r4 = rows[4] + at;
    const float* __restrict r5 = rows[5] + at;
    const float* __restrict r6 = rows[6] + at;
    const float* __restrict r7 = rows[7] + at;
    const float* __restrict r8 = rows[8] + at;
    for (int x = 0; x < cols; ++x) {
        out[x] = kTaps[4] * (r0[x] + r8[x]) + kTaps[3] * (r1[x] + r7[x]) + kTaps[2] * (r2[x] + r6[x]) +
                 kTaps[1] * (r3[x] + r5[x]) + kTaps[0] * r4[x];
    }
}

MIMETIC_WIDE void blur_along(int cols, const float* __restrict p, float* __restrict out) {
    for (int x = 0; x < cols; ++x) {
        out[x] = kTaps[4] * (p[x] + p[x + 8]) + kTaps[3] * (p[x + 1] + p[x + 7]) +
                 kTaps[2] * (p[x + 2] + p[x + 6]) + kTaps[1] * (p[x + 3] + p[x + 5]) + kTaps[0] * p[x + 4];
    }
}

MIMETIC_WIDE void solve_row(int cols, const float* __restrict sums, const float* __restrict mean_x,
                            const float* __restrict mean_y, const float* __restrict xx,
                            const float* __restrict xy, const float* __restrict yy, float* __restrict out_x,
                            float* __restrict out_y, float* __restrict out_xx, float* __restrict out_xy,
                            float* __restrict out_yy) {
    for (int x = 0; x < cols; ++x) {
        const float prior = 1.0f / (xx[x] * yy[x] - xy[x] * xy[x]);
        const float mxx = sums[x];
        const float mxy = sums[cols + x];
        const float myy = sums[2 * cols + x];
        const float bx = sums[3 * cols + x];
        const float by = sums[4 * cols + x];
        const float ixx = mxx + prior * yy[x];
        const float ixy = mxy - prior * xy[x];
        const float iyy = myy + prior * xx[x];
        const float scale = 1.0f / (ixx * iyy - ixy * ixy);
        const float dx = -scale * (iyy * bx - ixy * by);
        const float dy = -scale * (ixx * by - ixy * bx);
        // Residual after the step in units of the noise assumed: above 1 the window holds an occlusion, a
        // highlight or two motions, and the covariance must grow.
        const float residual =
            sums[5 * cols + x] + dx * (2 * bx + mxx * dx + 2 * mxy * dy) + dy * (2 * by + myy * dy);
        // the larger of residual and 1, written so that the loop vectorises
        const float inflation = scale * 0.5f * (1.0f + residual + std::abs(residual - 1.0f));
        out_x[x] = mean_x[x] + dx;
        out_y[x] = mean_y[x] + dy;
        out_xx[x] = inflation * iyy;
        out_xy[x] = -inflation * ixy;
        out_yy[x] = inflation * ixx;
    }
}

MIMETIC_WIDE void enlarge_row(int coarse_cols, int fine_cols, const float* __restrict above,
                              const float* __restrict below, float factor, float offset,
                              float* __restrict mixed, float* __restrict out) {
    for (int x = 0; x < coarse_cols; ++x) {
        mixed[x] = 0.5f * factor * (above[x] + below[x]) + offset;
    }
    mixed[coarse_cols] = mixed[coarse_cols - 1];
    const int num_pairs = fine_cols / 2;
    for (int x = 0; x < num_pairs; ++x) {
        out[2 * x] = mixed[x];
        out[2 * x + 1] = 0.5f * (mixed[x] + mixed[x + 1]);
    }
    if (fine_cols % 2 != 0) {
        out[fine_cols - 1] = mixed[num_pairs];
    }
}

}  // namespace

void Belief::create(int rows, int cols) {
    for (cv::Mat* plane : planes()) {
        plane->create(rows, cols, CV_32F);
    }
}

void form_products(const Level& level, const Belief& prior, const cv::Mat& at_x, const cv::Mat& at_y, int y,
                   float* products) {
    const int cols = level.from.cols;
    std::vector<float> scratch(static_cast<std::size_t>(4 * cols));
    float* difference = scratch.data();
    float* inside = difference + cols;
    float* shift_x = inside + cols;
    float* shift_y = shift_x + cols;
    warp_row(level.to.ptr<float>(), level.to.rows, cols, y, at_x.ptr<float>(y), at_y.ptr<float>(y),
             level.from.ptr<float>(y), difference, inside);
    subtract_row(cols, at_x.ptr<float>(y), prior.x.ptr<float>(y), shift_x);
    subtract_row(cols, at_y.ptr<float>(y), prior.y.ptr<float>(y), shift_y);
    multiply_row(cols, level.gx.ptr<float>(y), level.gy.ptr<float>(y), level.weight.ptr<float>(y), difference,
                 inside, shift_x, shift_y, products, products + cols, products + 2 * cols,
                 products + 3 * cols, products + 4 * cols, products + 5 * cols);
}

void sum_window(const float* const* rows, int cols, float* scratch, float* sums) {
    for (int k = 0; k < kNumProducts; ++k) {
        const std::ptrdiff_t at = std::ptrdiff_t{k} * cols;
        float* row = scratch + kReach;
        blur_rows(cols, rows, at, row);
        for (int i = 1; i <= kReach; ++i) {
            row[-i] = row[i];
            row[cols - 1 + i] = row[cols - 1 - i];
        }
        blur_along(cols, scratch, sums + at);
    }
}

void update_row(const float* sums, const Belief& prior, int y, Belief& posterior) {
    solve_row(prior.x.cols, sums, prior.x.ptr<float>(y), prior.y.ptr<float>(y), prior.xx.ptr<float>(y),
              prior.xy.ptr<float>(y), prior.yy.ptr<float>(y), posterior.x.ptr<float>(y),
              posterior.y.ptr<float>(y), posterior.xx.ptr<float>(y), posterior.xy.ptr<float>(y),
              posterior.yy.ptr<float>(y));
}

void enlarge(const Belief& coarse, float process_variance, Belief& fine) {
    const int coarse_rows = coarse.x.rows;
    std::vector<float> mixed(static_cast<std::size_t>(coarse.x.cols) + 1);
    for (std::size_t k = 0; k < 5; ++k) {
        const float factor = k < 2 ? 2.0f : 4.0f;
        const float offset = k == 2 || k == 4 ? process_variance : 0.0f;
        for (int y = 0; y < fine.x.rows; ++y) {
            const int above = y / 2;
            const int below = std::min(above + y % 2, coarse_rows - 1);
            enlarge_row(coarse.x.cols, fine.x.cols, coarse.planes()[k]->ptr<float>(above),
                        coarse.planes()[k]->ptr<float>(below), factor, offset, mixed.data(),
                        fine.planes()[k]->ptr<float>(y));
        }
    }
}

}  // namespace mimetic::flow
