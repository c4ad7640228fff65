// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

namespace mimetic::locate {

/// The outputs (float32) of a network for an input, in the order of their lengths.
std::vector<cv::Mat> outputs_of(cv::dnn::Net& net, const cv::Mat& blob);

/// A network whose outputs have the wanted lengths, rising; tried once, as a damaged file shows then.
/// input: channels, rows, columns. Throws UnreadableMedia.
cv::dnn::Net load_network(const std::string& file, const std::array<int, 3>& input,
                          const std::vector<std::size_t>& lengths);

}  // namespace mimetic::locate
