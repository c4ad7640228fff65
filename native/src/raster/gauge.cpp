// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/raster/gauge.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace mimetic {

Eigen::Vector3f quality_colour(double quality, double held_quality) {
    if (quality < held_quality) {
        return {255, 70, 60};
    }
    const Eigen::Vector3f doubtful(255, 190, 60), good(90, 235, 215);
    const auto t = static_cast<float>(std::clamp((quality - held_quality) / (0.7 - held_quality), 0.0, 1.0));
    return doubtful * (1 - t) + good * t;
}

void draw_gauge(ColorImage& picture, double quality, double held_quality, int frame) {
    cv::Mat image(picture.rows, picture.cols, CV_8UC3, picture.pixels.data());
    const double unit = std::max(1.0, image.rows / 360.0);
    const auto px = [unit](double value) { return static_cast<int>(std::lround(value * unit)); };
    const cv::Rect strip =
        cv::Rect(0, image.rows - px(22), image.cols, px(22)) & cv::Rect({0, 0}, image.size());
    cv::Mat under = image(strip);
    under *= 0.35;
    const int baseline = image.rows - px(7);
    const auto write = [&](const std::string& words, int x) {
        cv::putText(image, words, {x, baseline}, cv::FONT_HERSHEY_SIMPLEX, 0.4 * unit, {255, 255, 255}, px(1),
                    cv::LINE_AA);
    };
    write("frame " + std::to_string(frame), px(8));
    const cv::Rect bar(px(100), image.rows - px(15), px(120), px(8));
    cv::rectangle(image, bar, cv::Scalar(90, 90, 90), cv::FILLED);
    const cv::Rect filled(
        bar.x, bar.y, static_cast<int>(std::lround(bar.width * std::clamp(quality, 0.0, 1.0))), bar.height);
    const Eigen::Vector3f colour = quality_colour(quality, held_quality);
    cv::rectangle(image, filled, cv::Scalar(colour[0], colour[1], colour[2]), cv::FILLED);
    const bool held = quality < held_quality;
    write(held ? "held" : "quality " + std::to_string(quality).substr(0, 4), bar.x + bar.width + px(8));
}

}  // namespace mimetic
