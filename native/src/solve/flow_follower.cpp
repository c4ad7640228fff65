// SPDX-License-Identifier: GPL-3.0-or-later
#include "flow_follower.hpp"

#include <opencv2/imgproc.hpp>

namespace mimetic {

namespace {

constexpr int kFaceHeight = 110;       // pixels of the face for the flow
constexpr std::size_t kSamples = 500;  // of the view, approximately

}  // namespace

FlowFollower::FlowFollower(const TrackedFace& face, const Cover& cover, ErrorField<float> error_field)
    : face_(face),
      cover_(cover),
      solver_(face.motion, std::move(error_field)),
      flow_(cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST)) {}

FlowFollower::PartFlow FlowFollower::flow_of_face(const cv::Mat1b& last, const cv::Mat1b& gray,
                                                  const ReferenceView& view) {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9f), high = -low;
    for (const ReferenceSample& sample : view.samples()) {
        const Eigen::Vector2f pixel = projected_.pixels.row(face_.surface.triangles()(sample.triangle, 0));
        low = low.cwiseMin(pixel);
        high = high.cwiseMax(pixel);
    }
    const Eigen::Vector2f margin = .5f * (high - low);
    PartFlow part;
    part.box = cv::Rect(cv::Point2f(low.x() - margin.x(), low.y() - margin.y()),
                        cv::Point2f(high.x() + margin.x(), high.y() + margin.y())) &
               cv::Rect(0, 0, gray.cols, gray.rows);
    if (part.box.width < 32 || part.box.height < 32) {
        return part;
    }
    part.scale = std::min(1., kFaceHeight / static_cast<double>(high.y() - low.y()));
    if (std::min(part.box.width, part.box.height) * part.scale < 24) {
        return part;
    }
    cv::Mat1b before, after;
    cv::resize(last(part.box), before, cv::Size(), part.scale, part.scale, cv::INTER_AREA);
    cv::resize(gray(part.box), after, cv::Size(), part.scale, part.scale, cv::INTER_AREA);
    flow_->calc(before, after, part.flow);
    return part;
}

std::vector<SampleMeasurement> FlowFollower::measure(const PartFlow& part, const ReferenceView& view) const {
    std::vector<SampleMeasurement> measurements;
    const std::size_t stride = 1 + view.samples().size() / kSamples;
    for (std::size_t k = 0; k < view.samples().size(); k += stride) {
        const ReferenceSample& sample = view.samples()[k];
        const Eigen::Vector2f pixel = place_of(sample, face_.surface.triangles(), projected_);
        const int x =
            static_cast<int>(std::lround((pixel.x() - static_cast<float>(part.box.x)) * part.scale));
        const int y =
            static_cast<int>(std::lround((pixel.y() - static_cast<float>(part.box.y)) * part.scale));
        if (x < 0 || y < 0 || x >= part.flow.cols || y >= part.flow.rows ||
            cover_.hides(pixel.cast<double>())) {
            continue;
        }
        SampleMeasurement measurement;
        measurement.sample = &sample;
        measurement.displacement = Eigen::Vector2d(part.flow(y, x)[0], part.flow(y, x)[1]) / part.scale;
        measurement.covariance = Eigen::Matrix2d::Identity() * std::pow(.5 / part.scale, 2);
        measurement.correlation = 1;
        measurement.weight = sample.is_behind_rim ? 0 : sample.weight;
        measurements.push_back(measurement);
    }
    return measurements;
}

FaceState FlowFollower::follow(const Expectation& expected, const TrackMemory& memory, const cv::Mat1b& gray,
                               const ReferenceView& view) {
    projected_.update(face_.surface, face_.camera, memory.state.camera_from_head, memory.state.values);
    const PartFlow part = flow_of_face(memory.gray, gray, view);
    if (part.flow.empty()) {
        return expected.mean;
    }
    const std::vector<SampleMeasurement> measurements = measure(part, view);
    NoiseModel wide = face_.noise;
    wide.robust_cut = 8;
    wide.samples_a_window = 10;
    FaceState state = memory.state;
    solver_.linearise(face_.camera, state, measurements, wide);
    state.apply(FaceStep(solver_.solve(expected.from(state, face_), state, face_.num_unknowns(), 2)));
    return state;
}

}  // namespace mimetic
