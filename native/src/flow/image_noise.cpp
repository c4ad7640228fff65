// SPDX-License-Identifier: GPL-3.0-or-later
#include "flow/image_noise.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flow/rows.hpp"
#include "shared/robust.hpp"

namespace mimetic::flow {
namespace {

constexpr float kRounding = 1.0f / 6;  // grey levels^2: both images are rounded to whole ones
constexpr double kSkinSigma = 2;       // pixels: finer structure is averaged out by a flow's window
constexpr float kMostColor = 20;       // of codecs; an image without any fine part has no bound
constexpr int kBlock = 2;              // pixels: the residual is kept by blocks, for speed
constexpr int kCell = 4;               // blocks
constexpr double kSpread = 1;          // cells: the noise is estimated from place to place no finer
constexpr int kRowsInBand = 16;        // of blocks

/// Residual of a flow between two images, by blocks of 2 x 2 pixels, CV_32F.
struct Residual {
    cv::Mat mean;  ///< grey levels
    cv::Mat fine;  ///< what changes its sign along both axes, grey levels, scaled as white noise is
};

/// Kept from call to call: fresh pages would cost more than all that is computed in them.
struct Workspace {
    cv::Mat from, to;  ///< CV_32F
    Residual residual;
    cv::Mat blurred;
    cv::Mat square;
    cv::Mat skin, pixel;  ///< power by cells
    cv::Mat scales;
};

/// Residual of row `y`, grey levels; 0 where the flow leaves the image. `scratch` holds 3 rows.
void residual_row(const cv::Mat& from, const cv::Mat& to, const FlowField& field, int y, float* scratch,
                  float* residual) {
    float* flow_x = scratch;
    float* flow_y = scratch + field.cols;
    const float* flow = field.flow_at(y, 0);
    for (int x = 0; x < field.cols; ++x) {
        flow_x[x] = flow[2 * x];
        flow_y[x] = flow[2 * x + 1];
    }
    float* inside = scratch + 2 * field.cols;
    warp_row(to.ptr<float>(), to.rows, to.cols, y, flow_x, flow_y, from.ptr<float>(y), residual, inside);
    for (int x = 0; x < field.cols; ++x) {
        residual[x] *= inside[x];
    }
}

void find_residual(const cv::Mat& from, const cv::Mat& to, const FlowField& field, Workspace& work) {
    from.convertTo(work.from, CV_32F);
    to.convertTo(work.to, CV_32F);
    const cv::Size size(from.cols / kBlock, from.rows / kBlock);
    Residual& residual = work.residual;
    residual.mean.create(size, CV_32F);
    residual.fine.create(size, CV_32F);
    const auto fill = [&](const cv::Range& bands) {
        const auto cols = static_cast<std::size_t>(from.cols);
        std::vector<float> scratch(3 * cols);
        std::vector<float> upper(cols);
        std::vector<float> lower(cols);
        const int end = std::min(bands.end * kRowsInBand, size.height);
        for (int y = bands.start * kRowsInBand; y < end; ++y) {
            residual_row(work.from, work.to, field, 2 * y, scratch.data(), upper.data());
            residual_row(work.from, work.to, field, 2 * y + 1, scratch.data(), lower.data());
            auto* mean = residual.mean.ptr<float>(y);
            auto* fine = residual.fine.ptr<float>(y);
            const float* a = upper.data();
            const float* b = lower.data();
            for (int x = 0; x < size.width; ++x) {
                mean[x] = (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]) / 4;
                fine[x] = (a[2 * x] - a[2 * x + 1] - b[2 * x] + b[2 * x + 1]) / 2;
            }
        }
    };
    cv::parallel_for_({0, (size.height + kRowsInBand - 1) / kRowsInBand}, fill);
}

/// Mean of the squares, about each cell.
void find_power(const cv::Mat& plane, cv::Mat& square, cv::Mat& cells) {
    cv::multiply(plane, plane, square);
    const cv::Size size((plane.cols + kCell - 1) / kCell, (plane.rows + kCell - 1) / kCell);
    cv::resize(square, cells, size, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(cells, cells, {}, kSpread);
}

/// Variance that white noise would have to be as strong at the wave lengths of skin.
void find_skin_power(Workspace& work) {
    constexpr double kSigma = kSkinSigma / kBlock;
    const cv::Mat kernel = cv::getGaussianKernel(2 * static_cast<int>(3 * kSigma) + 1, kSigma, CV_32F);
    cv::sepFilter2D(work.residual.mean, work.blurred, CV_32F, kernel, kernel);
    find_power(work.blurred, work.square, work.skin);
    const double left = cv::norm(kernel, cv::NORM_L2SQR) / kBlock;  // of white noise, along each axis
    work.skin /= left * left;
}

/// Of the image as a whole, by the median, so that what covers a part does not count. Where an image stands
/// still a codec leaves no difference at all, which carries no information.
float color_of(const cv::Mat& skin, const cv::Mat& pixel) {
    constexpr float kLeast = 2 * kRounding;
    std::vector<float> colors;
    for (int y = 0; y < skin.rows; ++y) {
        for (int x = 0; x < skin.cols; ++x) {
            if (skin.at<float>(y, x) > kLeast) {
                colors.push_back((skin.at<float>(y, x) + kRounding) / (pixel.at<float>(y, x) + kRounding));
            }
        }
    }
    return upper_median(colors);
}

}  // namespace

void own_up_to_noise(const cv::Mat& from, const cv::Mat& to, const NoiseResponse& response,
                     FlowField& field) {
    thread_local Workspace kept;
    Workspace& work = kept;  // the threads below have their own
    find_residual(from, to, field, work);
    find_skin_power(work);
    find_power(work.residual.fine, work.square, work.pixel);
    const float color = std::min(kMostColor, color_of(work.skin, work.pixel));
    const float floor = response.floor * std::max(0.0f, color - response.white);
    cv::pow(work.skin + kRounding, response.exponent, work.skin);
    work.skin *= response.scale;
    cv::resize(work.skin, work.scales, from.size(), 0, 0, cv::INTER_LINEAR);
    cv::Mat covariance(field.rows, field.cols, CV_32FC3, field.covariance.data());
    cv::parallel_for_({0, from.rows}, [&](const cv::Range& rows) {
        for (int y = rows.start; y < rows.end; ++y) {
            float* out = covariance.ptr<float>(y);
            const float* scale = work.scales.ptr<float>(y);
            for (int x = 0; x < from.cols; ++x) {
                out[3 * x] = scale[x] * out[3 * x] + floor;
                out[3 * x + 1] *= scale[x];
                out[3 * x + 2] = scale[x] * out[3 * x + 2] + floor;
            }
        }
    });
}

}  // namespace mimetic::flow
