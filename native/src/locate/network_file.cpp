// SPDX-License-Identifier: GPL-3.0-or-later
#include "network_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mimetic/shared/error.hpp>

namespace mimetic::locate {
namespace {

constexpr std::uintmax_t kLargestFile = 16u << 20;

std::vector<char> content_of(const std::string& file) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure)) {
        throw UnreadableMedia(file + ": no such file; scripts/make_networks makes it");
    }
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    if (failure || size == 0 || size > kLargestFile) {
        throw UnreadableMedia(file +
                              ": not a network of ours, which have up to 16 MB; run "
                              "scripts/make_networks again");
    }
    std::vector<char> content(size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
        throw UnreadableMedia(file + ": cannot be read");
    }
    return content;
}

}  // namespace

std::vector<cv::Mat> outputs_of(cv::dnn::Net& net, const cv::Mat& blob) {
    net.setInput(blob);
    std::vector<cv::Mat> outputs;
    // In one thread: for layers this small synchronising threads costs more than it gains, much more where
    // other programs keep the processors busy. OpenCV does not nest its parallel loops.
    cv::parallel_for_({0, 1},
                      [&](const cv::Range&) { net.forward(outputs, net.getUnconnectedOutLayersNames()); });
    std::sort(outputs.begin(), outputs.end(),
              [](const cv::Mat& a, const cv::Mat& b) { return a.total() < b.total(); });
    return outputs;
}

cv::dnn::Net load_network(const std::string& file, const std::array<int, 3>& input,
                          const std::vector<std::size_t>& lengths) {
    const std::vector<char> content = content_of(file);
    bool fits = false;
    cv::dnn::Net net;
    try {
        net = cv::dnn::readNetFromONNX(content.data(), content.size());
        net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
        const int shape[] = {1, input[0], input[1], input[2]};
        const std::vector<cv::Mat> outputs = outputs_of(net, cv::Mat(4, shape, CV_32F, cv::Scalar(0.5)));
        fits = outputs.size() == lengths.size();
        for (std::size_t i = 0; fits && i < lengths.size(); ++i) {
            fits = outputs[i].total() == lengths[i] && outputs[i].type() == CV_32F &&
                   outputs[i].isContinuous() && cv::checkRange(outputs[i]);
        }
    } catch (const cv::Exception&) {
    }
    if (!fits) {
        throw UnreadableMedia(file + ": damaged, or not a network of ours; run scripts/make_networks again");
    }
    return net;
}

}  // namespace mimetic::locate
