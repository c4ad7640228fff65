// SPDX-License-Identifier: GPL-3.0-or-later
// E. P. Simoncelli, E. H. Adelson, D. J. Heeger, "Probability distributions of optical flow", CVPR 1991;
// coarse to fine as a Kalman filter over scale.
#include <algorithm>
#include <array>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flow/methods.hpp"
#include "flow/rows.hpp"

namespace mimetic::flow {
namespace {

constexpr int kRowsInBand = 32;
// Low-pass and derivative that match: derivative * image = d/dx (low-pass * image). Farid and Simoncelli
// (2004).
const cv::Matx<float, 1, 5> kLowPass(0.037659f, 0.249153f, 0.426375f, 0.249153f, 0.037659f);
const cv::Matx<float, 1, 5> kDerivative(-0.109604f, -0.276691f, 0, 0.276691f, 0.109604f);

/// One level's images and beliefs.
struct Step {
    Level level;
    Belief prior;
    Belief posterior;
    cv::Mat at_x, at_y;
};

/// Kept from call to call: fresh pages for 20 MB a frame would cost a quarter of the time.
struct Workspace {
    std::vector<cv::Mat> from;
    std::vector<cv::Mat> to;
    std::vector<Step> steps;
};

int count_levels(int rows, int cols, const FlowOptions& options) {
    constexpr int kCoarsestSide = 12;
    int num_levels = 1;
    for (int side = std::min(rows, cols) / 2; side >= kCoarsestSide; side /= 2) {
        ++num_levels;
    }
    return options.num_levels == 0 ? num_levels : std::min(options.num_levels, num_levels);
}

void fill_level(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options, Level& level) {
    cv::sepFilter2D(from, level.from, CV_32F, kLowPass, kLowPass);
    cv::sepFilter2D(to, level.to, CV_32F, kLowPass, kLowPass);
    cv::sepFilter2D(from, level.gx, CV_32F, kDerivative, kLowPass);
    cv::sepFilter2D(from, level.gy, CV_32F, kLowPass, kDerivative);
    level.weight.create(from.size(), CV_32F);
    const auto s1 = static_cast<float>(options.gradient_noise);
    const auto s2 = static_cast<float>(options.temporal_noise);
    for (int y = 0; y < from.rows; ++y) {
        const float* gx = level.gx.ptr<float>(y);
        const float* gy = level.gy.ptr<float>(y);
        float* weight = level.weight.ptr<float>(y);
        for (int x = 0; x < from.cols; ++x) {
            weight[x] = 1.0f / (s1 * (gx[x] * gx[x] + gy[x] * gy[x]) + s2);
        }
    }
}

/// Posterior of the rows of one band, the second image warped by (`at_x`, `at_y`).
void update_band(const Level& level, const Belief& prior, const cv::Mat& at_x, const cv::Mat& at_y,
                 const cv::Range& band, Belief& posterior) {
    const int rows = level.from.rows;
    const int cols = level.from.cols;
    const std::ptrdiff_t run = std::ptrdiff_t{kNumProducts} * cols;
    constexpr int kNumRows = 2 * kReach + 1;
    std::vector<float> ring(static_cast<std::size_t>(kNumRows * run));
    std::vector<float> sums(static_cast<std::size_t>(run));
    std::vector<float> scratch(static_cast<std::size_t>(cols) + 2 * kReach);
    const auto slot = [&](int y) { return ring.data() + (y + kNumRows) % kNumRows * run; };
    for (int y = band.start - kReach; y < band.end + kReach; ++y) {
        form_products(level, prior, at_x, at_y, cv::borderInterpolate(y, rows, cv::BORDER_REFLECT_101),
                      slot(y));
        if (y < band.start + kReach) {
            continue;
        }
        std::array<const float*, kNumRows> window{};
        for (int i = 0; i < kNumRows; ++i) {
            window[static_cast<std::size_t>(i)] = slot(y - kNumRows + 1 + i);
        }
        sum_window(window.data(), cols, scratch.data(), sums.data());
        update_row(sums.data(), prior, y - kReach, posterior);
    }
}

void update_level(Step& step, int iterations) {
    const int num_rows = step.level.from.rows;
    const int num_bands = (num_rows + kRowsInBand - 1) / kRowsInBand;
    for (int i = 0; i < iterations; ++i) {
        (i == 0 ? step.prior : step.posterior).x.copyTo(step.at_x);
        (i == 0 ? step.prior : step.posterior).y.copyTo(step.at_y);
        cv::parallel_for_(cv::Range(0, num_bands), [&](const cv::Range& bands) {
            for (int band = bands.start; band < bands.end; ++band) {
                const cv::Range rows(band * kRowsInBand, std::min((band + 1) * kRowsInBand, num_rows));
                update_band(step.level, step.prior, step.at_x, step.at_y, rows, step.posterior);
            }
        });
    }
}

/// The start of the search at every level, each as two planes; empty without an initial flow.
std::vector<std::array<cv::Mat, 2>> make_starts(const cv::Mat& initial, int num_levels) {
    std::vector<std::array<cv::Mat, 2>> starts;
    if (initial.empty()) {
        return starts;
    }
    starts.resize(static_cast<std::size_t>(num_levels));
    cv::split(initial, starts[0].data());
    for (std::size_t level = 1; level < starts.size(); ++level) {
        for (std::size_t k = 0; k < 2; ++k) {
            cv::pyrDown(starts[level - 1][k], starts[level][k]);
            starts[level][k] *= 0.5;
        }
    }
    return starts;
}

void shift(Belief& belief, const std::array<cv::Mat, 2>& by, double sign) {
    cv::scaleAdd(by[0], sign, belief.x, belief.x);
    cv::scaleAdd(by[1], sign, belief.y, belief.y);
}

/// Prior of a level, before its images are used.
void begin_prior(const Belief* coarser, const cv::Size& size, const FlowOptions& options, bool is_measured,
                 Belief& prior) {
    prior.create(size.height, size.width);
    if (coarser != nullptr) {
        enlarge(*coarser, is_measured ? static_cast<float>(options.process_variance) : 0.0f, prior);
        return;
    }
    for (cv::Mat* plane : prior.planes()) {
        plane->setTo(0);
    }
    prior.xx.setTo(options.prior_variance);
    prior.yy.setTo(options.prior_variance);
}

FlowField pack(const Belief& belief) {
    FlowField field;
    field.rows = belief.x.rows;
    field.cols = belief.x.cols;
    const auto num_pixels = belief.x.total();
    field.flow.resize(2 * num_pixels);
    field.covariance.resize(3 * num_pixels);
    cv::Mat flow(field.rows, field.cols, CV_32FC2, field.flow.data());
    cv::merge(std::array{belief.x, belief.y}.data(), 2, flow);
    cv::Mat covariance(field.rows, field.cols, CV_32FC3, field.covariance.data());
    cv::merge(std::array{belief.xx, belief.xy, belief.yy}.data(), 3, covariance);
    covariance *= kProbabilisticScale;
    return field;
}

}  // namespace

FlowField compute_probabilistic(const cv::Mat& from, const cv::Mat& to, const FlowOptions& options,
                                const cv::Mat& initial) {
    thread_local Workspace work;
    const int num_levels = count_levels(from.rows, from.cols, options);
    const int finest = std::min(options.finest_level, num_levels - 1);
    cv::buildPyramid(from, work.from, num_levels - 1);
    cv::buildPyramid(to, work.to, num_levels - 1);
    work.steps.resize(static_cast<std::size_t>(num_levels));
    const auto starts = make_starts(initial, num_levels);

    const Belief* coarser = nullptr;
    for (int i = num_levels - 1; i >= 0; --i) {
        const auto at = static_cast<std::size_t>(i);
        Step& step = work.steps[at];
        begin_prior(coarser, work.from[at].size(), options, i >= finest, step.prior);
        if (i < finest) {
            coarser = &step.prior;
            continue;
        }
        if (!starts.empty()) {
            shift(step.prior, starts[at], 1);
        }
        fill_level(work.from[at], work.to[at], options, step.level);
        step.posterior.create(step.prior.x.rows, step.prior.x.cols);
        // At full size the prior is within a fraction of a pixel, where one step does.
        update_level(step, i == 0 ? std::max(1, options.iterations - 1) : options.iterations);
        if (!starts.empty()) {
            shift(step.posterior, starts[at], -1);
        }
        coarser = &step.posterior;
    }
    FlowField field = pack(*coarser);
    if (!starts.empty()) {
        cv::Mat flow(field.rows, field.cols, CV_32FC2, field.flow.data());
        flow += initial;
    }
    return field;
}

}  // namespace mimetic::flow
