// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "locate/recognition.hpp"
#include "registration.hpp"
#include "view_graph.hpp"

namespace mimetic {

constexpr double kHeadMargin = 0.25;  // of the head's box: how far it may move from frame to frame
constexpr long kFlowEvery = 6;        // frames on the fast path: samples alone let the distance drift
constexpr double kFaceHeight = .7;    // of the head's
constexpr int kPortraitHeight = 286;  // pixels of the head: the face as large as in the capture's textures

struct HeadTracker::State {
    Camera camera;
    HeadOptions options;
    head::ViewGraph graph;
    cv::Mat1b before;  // the last frame
    HeadEstimate last;
    Likeness likeness;
    // Between textures a rigid model has less detail than beside one: two thirds, where strangers have a
    // third
    Recognition recognition{.62, .66, .75};
    std::optional<Look> look;                                // of the present frame, where it was compared
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();  // of the head in its own frame, frame to frame
    // Of each view, on the fast path, made on demand: relaxing moves all of them
    mutable std::vector<std::optional<head::SampleView>> sampled;
    // Each view in the resolution in which people differ, and on the model, made on demand
    std::vector<head::HeadCrop> portrait_crops;
    std::vector<std::optional<head::KeyView>> portraits;
    std::vector<long> taken_in;  // frame of each view
    long num_frames = 0;
    long refused = -kFlowEvery;  // frame in which flow did not confirm a texture

    State(const Camera& of, const HeadShape& start, const HeadOptions& given)
        : camera(of), options(given), graph(start, given), likeness(kFaceHeight * kPortraitHeight) {}
    const HeadShape& shape() const { return graph.shape(); }
    const std::vector<head::KeyView>& views() const { return graph.views(); }
    cv::Mat1b gray_frame(const ColorView& image) const { return head::gray_frame(image, camera); }
    std::optional<Camera> crop_at(const Eigen::Isometry3d& pose) const {
        return head::crop_camera(shape(), camera, pose, options.crop_height, kHeadMargin);
    }
    std::optional<Camera> portrait_crop_at(const Eigen::Isometry3d& pose) const {
        return head::crop_camera(shape(), camera, pose, kPortraitHeight, kHeadMargin);
    }
    void take_view(const cv::Mat1b& gray, HeadEstimate& estimate);
    bool relax(bool anew);
    /// What was made of the views where they were.
    void forget_places() {
        sampled.clear();
        sampled.resize(views().size());
        portraits.clear();
        portraits.resize(views().size());
    }
    const head::KeyView& portrait_of(const head::KeyView& view);
    const head::SampleView& samples_of(const head::KeyView& view) const;
    std::vector<std::pair<double, const head::KeyView*>> views_by_angle(const Eigen::Isometry3d& pose) const;
    std::vector<std::pair<double, const head::KeyView*>> views_for(const Eigen::Isometry3d& pose) const;
    std::optional<HeadEstimate> follow_flow(const cv::Mat1b& gray) const;
    std::optional<HeadEstimate> register_frame(const cv::Mat1b& gray, const Eigen::Isometry3d& start) const;
    std::optional<HeadEstimate> register_samples(const cv::Mat1b& gray) const;
    std::optional<Eigen::Isometry3d> recall(const cv::Mat1b& gray,
                                            const std::optional<Eigen::Isometry3d>& guess,
                                            std::size_t num_views) const;
    std::optional<HeadEstimate> follow(const cv::Mat1b& gray) const;
    std::optional<HeadEstimate> search(const cv::Mat1b& gray,
                                       const std::optional<Eigen::Isometry3d>& guess) const;
    Look look_at(const cv::Mat1b& gray, const Eigen::Isometry3d& pose);
    bool is_this_head(const cv::Mat1b& gray, std::optional<HeadEstimate>& found, double least_quality);
    HeadEstimate estimate(const cv::Mat1b& gray, const std::optional<Eigen::Isometry3d>& guess);
    bool wants_view(const HeadEstimate& estimate) const;
};

}  // namespace mimetic
