// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <mimetic/flow/flow.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

#include "flow/methods.hpp"
#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

void check_initial(const FlowField& initial, const GrayView& from) {
    const auto num_pixels = static_cast<std::size_t>(from.rows) * static_cast<std::size_t>(from.cols);
    if (initial.rows != from.rows || initial.cols != from.cols || initial.flow.size() != 2 * num_pixels) {
        throw InvalidInput("the initial flow is " + std::to_string(initial.cols) + " x " +
                           std::to_string(initial.rows) + ", the images " + std::to_string(from.cols) +
                           " x " + std::to_string(from.rows) + "; they must have one size");
    }
    for (const float value : initial.flow) {
        if (!std::isfinite(value)) {
            throw InvalidInput("the initial flow is not finite");
        }
    }
}

}  // namespace

double flow_blur_px(FlowMethod method) { return method == FlowMethod::dis ? 7.1 : 3.4; }

void FlowOptions::check() const {
    check_range("flow option num_levels", num_levels, 0, 12);
    check_range("flow option finest_level", finest_level, 0, 4);
    check_range("flow option iterations", iterations, 1, 20);
    check_range("flow option gradient_noise", gradient_noise, 0, 100);
    check_range("flow option temporal_noise", temporal_noise, 1e-3, 1e4);
    check_range("flow option prior_variance", prior_variance, 1e-3, 1e4);
    check_range("flow option process_variance", process_variance, 1e-6, 1e3);
}

FlowField compute_flow(const GrayView& from, const GrayView& to, const FlowOptions& options,
                       const FlowField* initial) {
    options.check();
    check_image_size(from.rows, from.cols, "the first image");
    check_image_size(to.rows, to.cols, "the second image");
    if (from.rows != to.rows || from.cols != to.cols) {
        throw InvalidInput("flow needs two images of one size; they are " + std::to_string(from.cols) +
                           " x " + std::to_string(from.rows) + " and " + std::to_string(to.cols) + " x " +
                           std::to_string(to.rows));
    }
    cv::Mat start;
    if (initial != nullptr) {
        check_initial(*initial, from);
        start = cv::Mat(from.rows, from.cols, CV_32FC2, const_cast<float*>(initial->flow.data()));
    }
    const bool is_dis = options.method == FlowMethod::dis;
    FlowField field = is_dis ? flow::compute_dis(as_matrix(from), as_matrix(to), options, start)
                             : flow::compute_probabilistic(as_matrix(from), as_matrix(to), options, start);
    if (options.judges_noise) {
        flow::own_up_to_noise(as_matrix(from), as_matrix(to),
                              is_dis ? flow::kDisNoise : flow::kProbabilisticNoise, field);
    }
    return field;
}

}  // namespace mimetic
