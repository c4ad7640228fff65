// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/camera.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

/// How much of a face's contrast is of the shortest waves, 2 pixels long along both axes, and stays on the
/// face from a frame to the next: the root of these waves' covariance between both, the next brought back by
/// its flow, over the standard deviation of grey levels, the median of blocks of 8 x 8 pixels in the middle
/// of the face. Noise, new in each frame, has about 0, white noise that stays 1; what a codec or a lens has
/// smoothed has little, whatever the light.
///
/// points_in_camera: K x 3, metres, of the face, in front of the camera. A face of more than most_height
/// pixels is scaled down to it first. 0 where too little is seen for a flow (`kSmallestImage`). Throws
/// InvalidInput: images of another size than the camera's, no points or one behind the camera, most_height
/// below 1.
double fine_contrast(const ColorView& image, const ColorView& next, const Camera& camera,
                     PointsIn points_in_camera, int most_height);

}  // namespace mimetic
