// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/clear_view.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace mimetic::locate {
namespace {

// The strongest channel over the grey value, on the mean: 1.1 to 1.55 of 30 real faces in usual light. From
// the first on the channel is taken for a part, from the second on alone: grey hardly counts blue
constexpr double kColored = 2, kOneColor = 3.5;
// Between the darkest and the brightest skin and features, as a share of the brightest: .45 to 1 there.
// Below the first contrast is raised for a part, below the second to what is usual
constexpr double kFlat = .25, kFlatter = .15, kUsual = .5;
constexpr double kDarkest = .05, kBrightest = .95;  // quantiles
constexpr double kSkin = 166;                       // grey value that the brightest gets
constexpr double kMostGain = 16;                    // more only raises noise

/// 0 at the first value, 1 from the second on.
double share_between(double none, double all, double value) {
    return std::clamp((value - none) / (all - none), 0., 1.);
}

/// The strongest channel in place of all, for a part.
cv::Mat in_strongest(const cv::Mat& color, const cv::Rect& part) {
    constexpr std::array kGray{.299, .587, .114};  // of red, green and blue
    const cv::Scalar mean = cv::mean(color(part));
    const double gray = kGray[0] * mean[0] + kGray[1] * mean[1] + kGray[2] * mean[2];
    const auto strongest = static_cast<int>(std::max_element(mean.val, mean.val + 3) - mean.val);
    const double share = share_between(kColored, kOneColor, mean[strongest] / std::max(1., gray));
    if (share <= 0) return color;
    cv::Mat channel, alone, mixed;
    cv::extractChannel(color, channel, strongest);
    cv::cvtColor(channel, alone, cv::COLOR_GRAY2RGB);
    cv::addWeighted(color, 1 - share, alone, share, 0, mixed);
    return mixed;
}

/// Grey values below which shares of a part's pixels lie.
std::array<double, 2> ends_of(const cv::Mat& color, const cv::Rect& part) {
    cv::Mat1b gray;
    cv::cvtColor(color(part), gray, cv::COLOR_RGB2GRAY);
    std::array<int, 256> counts{};
    for (const std::uint8_t value : gray) ++counts[value];
    std::array<double, 2> ends{};
    int below = 0;
    for (int value = 0; value < 256; ++value) {
        below += counts[static_cast<std::size_t>(value)];
        const double share = below / static_cast<double>(gray.total());
        if (share < kDarkest) ends[0] = value + 1;
        if (share < kBrightest) ends[1] = value + 1;
    }
    return ends;
}

cv::Mat with_contrast(const cv::Mat& color, const cv::Rect& part) {
    const auto [darkest, brightest] = ends_of(color, part);
    const double range = brightest - darkest;
    const double share = share_between(kFlat, kFlatter, range / std::max(1., brightest));
    if (share <= 0 || range <= 0) return color;
    const double black = brightest - range / kUsual;
    const double gain = std::min(kMostGain, kSkin / (brightest - black));
    cv::Mat raised;
    color.convertTo(raised, -1, 1 + share * (gain - 1), share * (-black * gain));
    return raised;
}

}  // namespace

cv::Mat clear_view(const cv::Mat& color, const cv::Rect& part) {
    if (part.empty()) return color;
    return with_contrast(in_strongest(color, part), part);
}

}  // namespace mimetic::locate
