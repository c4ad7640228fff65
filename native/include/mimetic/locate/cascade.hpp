// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

/// A window that passed every stage of a cascade.
struct CascadeHit {
    Eigen::Vector4d box = Eigen::Vector4d::Zero();  ///< left, top, width, height, pixels
    int votes = 0;                                  ///< overlapping windows merged into this one, at least 1
};

/// One of OpenCV's boosted cascades [Viola and Jones 2001] by itself, as a reference for other finders.
class CascadeDetector {
public:
    /// file: a cascade of Haar or local binary pattern features in OpenCV's XML. Throws InvalidInput.
    explicit CascadeDetector(const std::string& file);
    ~CascadeDetector();
    CascadeDetector(CascadeDetector&&) noexcept;
    CascadeDetector& operator=(CascadeDetector&&) noexcept;

    /// Every hit, the most votes first. smallest: least width as a part of the image's shorter side.
    std::vector<CascadeHit> detect(ColorView image, double smallest = 0.12) const;

private:
    struct Cascade;
    std::unique_ptr<Cascade> cascade_;
};

}  // namespace mimetic
