// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracked_face.hpp"

namespace mimetic {

TrackedFace::TrackedFace(const Camera& camera_in, const TrackedSurface& surface_in,
                         const FaceMotion& motion_in, const TrackerOptions& options_in)
    : camera(camera_in),
      motion(motion_in),
      to_rest(motion),
      surface(surface_in, motion_in),
      options(options_in),
      rest(rest_covariance(motion)) {
    constexpr double kFlowWindow = 9.5;  // reference pixels on a side
    // What errs beside noise, the skin between the modes and the blocks of a codec, is as wide on the face in
    // any texture: of the face's height.
    constexpr double kErrorWidth = .0475;
    const double window = std::max(kFlowWindow, kErrorWidth * options.crop_height);
    noise.model.anyway = options.model_error;
    noise.model.shape = options.shape_error;
    noise.samples_a_window = std::max(1., std::pow(window / options.sample_spacing, 2));
    // The prediction already tends to rest; more would delay onsets.
    constexpr double kFramesPerState = 12;
    rest_pull = rest.inverse() / kFramesPerState;
}

}  // namespace mimetic
