// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <opencv2/video/tracking.hpp>
#include <unordered_set>

#include "detail_solver.hpp"
#include "face_search.hpp"
#include "joint_solver.hpp"
#include "lid_meter.hpp"
#include "locate/likeness.hpp"
#include "motion_prior.hpp"

namespace mimetic {

/// Wall clock of one stage, added to a total when it goes out of scope.
class StageClock {
public:
    explicit StageClock(double& total_ms) : total_ms_(total_ms), start_(std::chrono::steady_clock::now()) {}
    ~StageClock() {
        total_ms_ +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;

private:
    double& total_ms_;
    std::chrono::steady_clock::time_point start_;
};

/// How well a state explains a frame.
struct FrameScore {
    double quality = 0;
    double correlation = 0;
    double likeness = 0;  // share of the texture in sight that looks as a reference texture has it
    int num_samples = 0;
    int num_explained = 0;
    int num_views = 0;
};

struct FaceTracker::State {
    State(const Camera& camera_in, const TrackedSurface& surface_in, const FaceMotion& motion_in,
          const std::vector<EyeSlit>& eyes_in, const TrackerOptions& options_in);

    // The steps of a frame, in order
    StepPrior predict();
    void follow_flow(const StepPrior& prior);
    FrameScore register_textures(const StepPrior& prior, int num_iterations, Eigen::Index num_free);
    FrameScore register_face(const StepPrior& prior, double least);
    FrameScore search_again(const StepPrior& prior, double near_quality,
                            const std::optional<Eigen::Isometry3d>& guess);
    FrameEstimate report(const FrameScore& score, const StepPrior& prior);
    void measure_lids(FrameEstimate& estimate);
    FloatPixels project_control(const FaceState& at) const;
    void add_key_view(const FrameScore& score, const DetailEstimate& detail);

    double look();
    bool is_vague(const StepPrior& prior) const;
    void measure(bool is_first, bool is_last, FrameScore& score);
    void raster_hypothesis();
    std::vector<std::size_t> choose_views() const;
    void find_visible(const ReferenceView& view, std::vector<float>& out) const;
    StepPrior at_state(const StepPrior& prior) const;
    Eigen::Index num_values() const { return motion.lower.size(); }
    double view_angle(const ReferenceView& view) const;
    double face_pixels_per_crop_pixel() const;

    Camera camera;
    FaceMotion motion;
    RestPull to_rest;
    FaceSurface surface;
    std::vector<LidMeter> lids;
    TrackerOptions options;
    NoiseModel noise;
    std::vector<std::unique_ptr<ReferenceView>> views;
    std::unique_ptr<JointSolver> solver, relative_solver;
    DetailSolver detail_solver;
    TextureFlow texture_flow;
    std::unique_ptr<FaceSearch> search;

    FaceState state;      // under estimate
    FaceState last;       // of the frame before
    FaceState predicted;  // the prior's mean
    Eigen::VectorXd velocity;
    Eigen::VectorXd last_step;  // from the solver's last linearisation
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd rest;       // prior covariance of the values
    Eigen::MatrixXd rest_pull;  // its information in one frame
    Eigen::VectorXd last_std;   // of the values
    bool lost = false;
    int frames_since_key_view = 0;
    Trial trial;

    cv::Mat1b gray, last_gray;
    PreparedFrame frame;
    ProjectedSurface projected;
    Raster raster;
    RasterGrid grid;
    cv::Mat2f map;
    cv::Mat1f stabilised;
    std::vector<float> visible;
    Likeness likeness;                                  // of reference textures
    std::unordered_set<const ReferenceSample*> unlike;  // covered: they say nothing of the face
    std::vector<SampleMeasurement> measurements;
    StageTimes times;
    cv::Ptr<cv::DISOpticalFlow> relative_dis;
};

void check_inputs(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                  const std::vector<EyeSlit>& eyes);

}  // namespace mimetic
