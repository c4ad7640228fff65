// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>

#include "motion_prior.hpp"
#include "tracked_face.hpp"

namespace mimetic {

namespace {

[[noreturn]] void fail(const std::string& what) { throw InvalidInput("face tracker: " + what); }

void check_surface(const TrackedSurface& surface, Eigen::Index num_vertices) {
    const Eigen::Index num_refined = surface.stencils.rows();
    if (surface.stencils.cols() != num_vertices || num_refined == 0) {
        fail("the stencils must map the " + std::to_string(num_vertices) +
             " vertices of neutral to refined ones, got " + std::to_string(num_refined) + " x " +
             std::to_string(surface.stencils.cols()));
    }
    if (surface.weights.size() != num_refined || !surface.weights.allFinite()) {
        fail("one finite weight a refined vertex is needed (" + std::to_string(num_refined) + ")");
    }
    if (surface.quads.rows() == 0 || surface.quads.minCoeff() < 0 ||
        surface.quads.maxCoeff() >= num_refined) {
        fail("the quads must name refined vertices 0 to " + std::to_string(num_refined - 1));
    }
}

void check_opening(const FeatureOpening& opening, Eigen::Index num_vertices, Eigen::Index num_values) {
    for (const std::vector<int>& line : opening.lines) {
        if (line.size() < 2 || *std::min_element(line.begin(), line.end()) < 0 ||
            *std::max_element(line.begin(), line.end()) >= num_vertices) {
            fail("a line of an eye or the mouth needs two vertices or more, from 0 to " +
                 std::to_string(num_vertices - 1));
        }
    }
    const bool is_eye = opening.lid_upper >= 0;
    for (const int value : opening.shutting) {
        if (value < 0 || value >= num_values) {
            fail("an opening is shut by value " + std::to_string(value) + "; there are " +
                 std::to_string(num_values));
        }
    }
    if (opening.lines.empty() || (is_eye && opening.lines.size() != 2) ||
        std::max({opening.lid_upper, opening.lid_lower, opening.jaw}) >= num_values) {
        fail("an eye needs two lines and lids among the " + std::to_string(num_values) +
             " values, a mouth at least a line, and a jaw among the values");
    }
}

}  // namespace

void TrackerOptions::check() const {
    check_range("TrackerOptions.crop_height", crop_height, 48, 1024);
    check_range("TrackerOptions.sample_spacing", sample_spacing, 1, 16);
    check_range("TrackerOptions.max_iterations", max_iterations, 1, 20);
    check_range("TrackerOptions.max_key_views", max_key_views, 0, 32);
    check_range("TrackerOptions.model_error", model_error, 1e-5, .05);
    check_range("TrackerOptions.shape_error", shape_error, 0, .05);
    check_range("TrackerOptions.correlation_time", correlation_time, 1, 1e6);
    check_range("TrackerOptions.held_quality", held_quality, 0, 1);
}

void check_inputs(const Camera& camera, const TrackedSurface& surface, const FaceMotion& motion,
                  const FeatureInputs& features) {
    camera.check();
    const Eigen::Index num_vertices = motion.neutral.rows();
    const Eigen::Index num_values = motion.modes.rows();
    if (num_vertices == 0 || !motion.neutral.allFinite()) {
        fail("neutral must have vertices with finite coordinates");
    }
    if (num_values == 0 || motion.modes.cols() != 3 * num_vertices || !motion.modes.allFinite()) {
        fail("modes must be finite and values x " + std::to_string(3 * num_vertices) + ", got " +
             std::to_string(num_values) + " x " + std::to_string(motion.modes.cols()));
    }
    if (motion.num_muscles < 0 || motion.num_muscles > num_values) {
        fail("num_muscles must lie between 0 and the number of modes, " + std::to_string(num_values));
    }
    for (const auto& [name, vector] : {std::pair{"lower", &motion.lower}, std::pair{"upper", &motion.upper},
                                       std::pair{"prior_std", &motion.prior_std}}) {
        if (vector->size() != num_values || !vector->allFinite()) {
            fail(std::string(name) + " must have one finite number a mode (" + std::to_string(num_values) +
                 ")");
        }
    }
    if ((motion.lower.array() > 0).any() || (motion.upper.array() < 0).any() ||
        (motion.prior_std.array() <= 0).any()) {
        fail("every value's bounds must hold 0, the rest state, and every prior_std be above 0");
    }
    if (motion.quickness.size() != 0 &&
        (motion.quickness.size() != num_values || !(motion.quickness.array() > 0).all())) {
        fail("quickness must be empty or have one number above 0 a mode");
    }
    if (motion.depth_std.size() != 0 &&
        (motion.depth_std.size() != num_values || !motion.depth_std.allFinite() ||
         (motion.depth_std.array() < 0).any())) {
        fail("depth_std must be empty or have one finite number of 0 or more a mode");
    }
    check_correlation(motion);
    if (motion.detail_modes.rows() != motion.detail_std.size() ||
        (motion.detail_std.size() > 0 && motion.detail_modes.cols() != 3 * num_vertices) ||
        !motion.detail_modes.allFinite() || !motion.detail_std.allFinite() ||
        (motion.detail_std.array() <= 0).any()) {
        fail("detail_modes must be finite and D x " + std::to_string(3 * num_vertices) +
             ", with D numbers above 0 in detail_std; got " + std::to_string(motion.detail_modes.rows()) +
             " x " + std::to_string(motion.detail_modes.cols()) + " and " +
             std::to_string(motion.detail_std.size()));
    }
    check_surface(surface, num_vertices);
    for (const FeatureOpening& opening : features.openings) {
        check_opening(opening, num_vertices, num_values);
    }
}

}  // namespace mimetic
