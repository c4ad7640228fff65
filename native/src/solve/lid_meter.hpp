// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

#include "face_surface.hpp"

namespace mimetic {

struct LidMeasurement {
    double closure = 0;  ///< of the upper lid: 0 as in the reference frame, 1 shut
    double std = 1;
    bool seen = false;
};

/// How far an upper lid is lowered, by the appearance of the eye's opening: the lid with its dark margin is a
/// layer that slides over the open eye of the reference frame. Flow cannot track a blink: the eye
/// disappears.
class LidMeter {
public:
    explicit LidMeter(const EyeSlit& slit) : slit_(slit) {}
    const EyeSlit& slit() const { return slit_; }

    /// pixels: the control vertices in the reference image.
    void take_reference(const cv::Mat1b& gray, const FloatPixels& pixels);
    /// pixels: the control vertices in this frame with open lids.
    LidMeasurement measure(const cv::Mat1b& gray, const FloatPixels& pixels) const;

private:
    static constexpr int kColumns = 7;
    static constexpr int kRows = 28;
    using Profile = Eigen::Matrix<double, kRows, kColumns>;

    bool fetch(const cv::Mat1b& gray, const FloatPixels& pixels, Profile& profile) const;
    void slide(double closure, Profile& expected) const;

    EyeSlit slit_;
    Profile open_ = Profile::Zero();
    bool usable_ = false;
};

}  // namespace mimetic
