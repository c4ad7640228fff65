// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <mimetic/locate/cascade.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <string>

#include "shared/gray.hpp"

namespace mimetic {

struct CascadeDetector::Cascade {
    cv::CascadeClassifier classifier;
    std::mutex detecting;  // OpenCV scales the picture in memory of the classifier: one at a time
};

CascadeDetector::CascadeDetector(const std::string& file) : cascade_(std::make_unique<Cascade>()) {
    bool loaded = false;
    try {
        loaded = std::filesystem::is_regular_file(file) && cascade_->classifier.load(file);
    } catch (const cv::Exception&) {  // not XML
    }
    if (!loaded) {
        throw InvalidInput("not a cascade that OpenCV can read: " + file + "; give one of its XML files");
    }
}

CascadeDetector::~CascadeDetector() = default;
CascadeDetector::CascadeDetector(CascadeDetector&&) noexcept = default;
CascadeDetector& CascadeDetector::operator=(CascadeDetector&&) noexcept = default;

std::vector<CascadeHit> CascadeDetector::detect(ColorView image, double smallest) const {
    check_image_size(image.rows, image.cols, "image");
    if (!(smallest >= 0.02 && smallest <= 1)) {
        throw InvalidInput("smallest is " + std::to_string(smallest) +
                           "; it is a part of the image's shorter side, 0.02 to 1");
    }
    const cv::Mat1b gray = to_gray(image);
    const int least = std::max(20, static_cast<int>(smallest * std::min(gray.rows, gray.cols)));
    std::vector<cv::Rect> boxes;
    std::vector<int> votes;
    // One neighbour, not OpenCV's usual three: the caller sets the threshold on the votes.
    const std::lock_guard lock(cascade_->detecting);
    cascade_->classifier.detectMultiScale(gray, boxes, votes, 1.1, 1, 0, {least, least});
    std::vector<CascadeHit> hits;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const cv::Rect& box = boxes[i];
        hits.push_back({Eigen::Vector4d(box.x, box.y, box.width, box.height), votes[i]});
    }
    std::stable_sort(hits.begin(), hits.end(),
                     [](const auto& a, const auto& b) { return a.votes > b.votes; });
    return hits;
}

}  // namespace mimetic
