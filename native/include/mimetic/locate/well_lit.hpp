// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/feature_crops.hpp>
#include <mimetic/shared/color_image.hpp>
#include <optional>

namespace mimetic {

struct FaceFeatures;

/// The square about a face that was found, about as large as the one that `feature_crops` places by the
/// pose of its head.
FeatureCrop crop_about(const FaceFeatures& face);

/// The picture with a badly lit face made brighter, and its darker half as bright as the other, one in light
/// of nearly one colour shown by its channel alone, and one in fog or glare with the contrast that is usual,
/// since what finds, follows and recognises faces has hardly seen such; none where the face is lit evenly and
/// well.
std::optional<ColorImage> well_lit(ColorView image, const FeatureCrop& face);

/// The whole picture made brighter where it is dark, and cleared of one colour and of fog, to look for a face
/// that was not found.
ColorImage with_raised_shadows(ColorView image);

}  // namespace mimetic
