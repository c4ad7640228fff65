// SPDX-License-Identifier: GPL-3.0-or-later
#include "lost_face_search.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

constexpr int kTemplateHeight = 40;

struct Candidate {
    double correlation;
    Eigen::Isometry3d pose;
};

}  // namespace

LostFaceSearch::LostFaceSearch(const cv::Mat1b& reference, const ReferenceView& view)
    : camera_from_head_(view.camera_from_head()) {
    const double height = view.mask().rows / view.scale();
    const double width = view.mask().cols / view.scale();
    // The border shows background, hair and neck: leave it out.
    const cv::Rect whole(0, 0, reference.cols, reference.rows);
    const cv::Rect box =
        cv::Rect(cv::Point2d(view.origin().x() + .12 * width, view.origin().y() + .12 * height),
                 cv::Size2d(.76 * width, .76 * height)) &
        whole;
    template_scale_ = static_cast<double>(kTemplateHeight) / std::max(1, box.height);
    centre_ = {box.x + .5 * box.width, box.y + .5 * box.height};
    cv::resize(reference(box), template_, cv::Size(), template_scale_, template_scale_, cv::INTER_AREA);
}

std::vector<Eigen::Isometry3d> LostFaceSearch::find(const Camera& camera, const cv::Mat1b& gray,
                                                    double face_scale) const {
    std::vector<Candidate> candidates;
    cv::Mat1b small;
    cv::Mat1f score;
    for (const double zoom : {.7, .84, 1., 1.19, 1.41}) {
        const double scale = template_scale_ / (face_scale * zoom);
        if (gray.rows * scale < template_.rows || gray.cols * scale < template_.cols ||
            gray.cols * scale > 2000) {
            continue;
        }
        cv::resize(gray, small, cv::Size(), scale, scale, cv::INTER_AREA);
        if (small.rows < template_.rows || small.cols < template_.cols) {
            continue;
        }
        cv::matchTemplate(small, template_, score, cv::TM_CCOEFF_NORMED);
        double best = 0;
        cv::Point place;
        cv::minMaxLoc(score, nullptr, &best, nullptr, &place);
        const Eigen::Vector2d centre =
            Eigen::Vector2d(place.x + .5 * template_.cols, place.y + .5 * template_.rows) / scale;
        Eigen::Isometry3d pose = camera_from_head_;
        const double depth = pose.translation().z() / (face_scale * zoom);
        const Eigen::Vector2d focal(camera.fx, camera.fy), middle(camera.cx, camera.cy);
        const Eigen::Vector2d anchor = camera.project(pose.translation()) - centre_;
        const Eigen::Vector2d origin = centre + anchor * face_scale * zoom;
        pose.translation().head<2>() = depth * (origin - middle).cwiseQuotient(focal);
        pose.translation().z() = depth;
        candidates.push_back({best, pose});
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.correlation > b.correlation; });
    std::vector<Eigen::Isometry3d> poses;
    for (const Candidate& candidate : candidates) {
        constexpr double kAlike = .4;
        if (candidate.correlation > kAlike && poses.size() < 2) {
            poses.push_back(candidate.pose);
        }
    }
    return poses;
}

}  // namespace mimetic
