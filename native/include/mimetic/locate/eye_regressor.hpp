// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/locate/feature_networks.hpp>
#include <string>

namespace mimetic {

/// Lids and irises by a small network of our own, fitted to drawn people by `scripts/train_eyes_and_lips`,
/// for where Google's are not installed. A call at a time: calls from several threads wait for each other.
class EyeRegressor {
public:
    /// Throws UnreadableMedia: missing, too large, or not such a network.
    explicit EyeRegressor(const std::string& file);
    ~EyeRegressor();
    EyeRegressor(EyeRegressor&&) noexcept;
    EyeRegressor& operator=(EyeRegressor&&) noexcept;

    /// One eye: of the contour the 16 points round it, with how far lids and iris may be off. left: the
    /// subject's left eye, which is mirrored. crop: as `feature_crops` places it.
    EyePoints eye(ColorView image, const FeatureCrop& crop, bool left) const;

private:
    struct Net;
    std::unique_ptr<Net> net_;
};

}  // namespace mimetic
