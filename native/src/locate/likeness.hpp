// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <opencv2/core.hpp>

namespace mimetic {

/// How much of what is in sight looks, patch by patch, as the reference texture does in the same place.
///
/// No flow may bend the picture first: with it, grass and other people's faces fit half of any texture, and
/// covers fit at their edges. Patches are compared one by one, so that what covers the face costs no more
/// than it hides, and by correlation, so that light may change.
class Likeness {
public:
    /// face_height: pixels of the face in the textures, chin to brows and forehead.
    explicit Likeness(double face_height);

    /// Textures without light and contrast, of a mean of 0 and some 40 grey levels deviation, and the weight
    /// of each pixel, 0 out of sight; all of one size. Returns the share of the texture in sight that is
    /// alike, 0 to 1; 0 where nothing is in sight.
    double compare(const cv::Mat1f& reference, const cv::Mat1f& present, const cv::Mat1f& weights);

    /// Of each pixel of the last comparison: normalised correlation of its patch, -1 to 1.
    const cv::Mat1f& correlations() const { return correlations_; }

    static constexpr float kAlike = .5f;  ///< correlation of a patch that shows the same skin

private:
    int patch_;    // pixels on a side
    double blur_;  // pixels
    cv::Mat1f correlations_;
    cv::Mat1f reference_, present_, product_, own_, other_;
};

// Likeness as `mimetic evaluate abuse --set tuning` shows it: a followed face has .7 to .9, under a hand that
// hides half of it .5; walls, grass and bars have .0 to .15, a stranger's features laid on this face's up
// to .3.
constexpr double kStillAlike = .3;  ///< to be followed on
constexpr double kSurelyAlike =
    .5;  ///< to be taken for the face after a loss or a cut: half way between both

/// How sure a tracker must be that a face is this one: for half a second after a loss or a cut more than
/// while it is followed.
class Trial {
public:
    void start() { frames_left_ = kFrames; }
    void next_frame() { frames_left_ = std::max(0, frames_left_ - 1); }
    void end() { frames_left_ = 0; }
    bool is_on() const { return frames_left_ > 0; }
    bool has_just_started() const { return frames_left_ == kFrames; }
    double least_likeness() const { return is_on() ? kSurelyAlike : kStillAlike; }

private:
    static constexpr int kFrames = 12;  // half a second
    int frames_left_ = 0;
};

}  // namespace mimetic
