// SPDX-License-Identifier: GPL-3.0-or-later
#include "seen_outline.hpp"
#include "tracker_state.hpp"

namespace mimetic {

SkinObservations FaceTracker::observations() const {
    const State& s = *state_;
    const auto& [samples, projected] = s.last_measured;
    const JointSolver& solver = s.registrar.solver();
    const std::size_t count = s.memory.is_lost ? 0 : std::min(samples.size(), solver.robust_weights().size());
    const auto rows = static_cast<Eigen::Index>(count);
    SkinObservations seen{Triangles(rows, 3), Points(rows, 3), Rows<double, 2>(rows, 2),
                          Rows<double, 4>(rows, 4)};
    for (std::size_t k = 0; k < count; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const SampleMeasurement& measurement = samples[k];
        const ReferenceSample& sample = *measurement.sample;
        seen.vertices.row(row) = s.face.surface.triangles().row(sample.triangle);
        seen.barycentric.row(row) = sample.barycentric.cast<double>();
        Eigen::Vector2d hypothesis = Eigen::Vector2d::Zero();
        for (int corner = 0; corner < 3; ++corner) {
            hypothesis += sample.barycentric[corner] *
                          projected.pixels.row(seen.vertices(row, corner)).transpose().cast<double>();
        }
        seen.pixels.row(row) = hypothesis + measurement.displacement;
        const Eigen::Matrix2d whitener = solver.whitener(k).cast<double>();
        const Eigen::Matrix2d information = whitener.transpose() * whitener;
        seen.information.row(row) << information(0, 0), information(0, 1), information(1, 0),
            information(1, 1);
    }
    return seen;
}

SkinObservations FaceTracker::outline(const ColorView& image) const {
    const State& s = *state_;
    s.check_frame(image);
    if (s.memory.is_lost) {
        return {Triangles(0, 3), Points(0, 3), Rows<double, 2>(0, 2), Rows<double, 4>(0, 4)};
    }
    return seen_outline(s.face.surface, s.face.camera, s.memory.state, image);
}

}  // namespace mimetic
