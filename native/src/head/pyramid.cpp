// SPDX-License-Identifier: GPL-3.0-or-later
#include "pyramid.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic::head {
namespace {

constexpr std::array<int, kLevels> kLightWindow{21, 15, 11};  // pixels over which light is constant
constexpr float kNoise = 9;  // grey levels^2: bare skin is not made into texture

}  // namespace

Pyramid make_pyramid(const HeadCrop& crop) {
    Pyramid pyramid;
    Camera camera = crop.camera;
    cv::Mat1f gray;
    crop.gray.convertTo(gray, CV_32F);
    for (std::size_t level = 0; level < pyramid.size(); ++level) {
        if (level > 0) {
            cv::Mat1f half;
            cv::pyrDown(gray, half);
            gray = half;
            camera = {camera.fx / 2, camera.fy / 2, camera.cx / 2, camera.cy / 2, half.cols, half.rows};
        }
        pyramid[level] = {camera, gray};
    }
    return pyramid;
}

cv::Mat1f normalised(const cv::Mat1f& gray, const cv::Mat1f& mask, std::size_t level) {
    const auto sum_of = [size = kLightWindow[level]](const cv::Mat1f& values) {
        cv::Mat1f sum;
        cv::boxFilter(values, sum, CV_32F, {size, size}, {-1, -1}, false, cv::BORDER_CONSTANT);
        return sum;
    };
    const cv::Mat1f of_head = gray.mul(mask);
    const cv::Mat1f share = sum_of(mask), sum = sum_of(of_head), square = sum_of(of_head.mul(of_head));
    cv::Mat1f made(gray.size());
    for (int y = 0; y < gray.rows; ++y) {
        for (int x = 0; x < gray.cols; ++x) {
            const float num = std::max(1.F, share(y, x)), mean = sum(y, x) / num;
            const float variance = std::max(0.F, square(y, x) / num - mean * mean);
            made(y, x) = mask(y, x) * (gray(y, x) - mean) / std::sqrt(variance + kNoise);
        }
    }
    return made;
}

}  // namespace mimetic::head
