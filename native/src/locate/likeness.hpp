// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

namespace mimetic {

/// How a picture compares with a reference texture.
struct Look {
    double alike = 0;   ///< share of the texture in sight that looks the same, patch by patch; 0 to 1
    double detail = 0;  ///< mean correlation of the finest detail in those patches, -1 to 1
};

/// How much of what is in sight looks, patch by patch, as the reference texture does in the same place.
///
/// No flow may bend the picture first: with it, grass and other people's faces fit half of any texture, and
/// covers fit at their edges. Patches are compared one by one, so that what covers the face costs no more
/// than it hides, and by correlation, so that light may change. All faces have eyes, mouth and nose in the
/// same places; what tells them apart is detail.
class Likeness {
public:
    /// face_height: pixels of the face in the textures, chin to brows and forehead.
    explicit Likeness(double face_height);

    /// Textures without light and contrast, of a mean of 0 and some 40 grey levels deviation, and the weight
    /// of each pixel, 0 out of sight; all of one size. Nothing is alike where nothing is in sight.
    Look compare(const cv::Mat1f& reference, const cv::Mat1f& present, const cv::Mat1f& weights);

    /// Of each pixel of the last comparison: normalised correlation of its patch, -1 to 1.
    const cv::Mat1f& correlations() const { return patches_.correlations; }

    static constexpr float kAlike = .5f;  ///< correlation of a patch that shows the same skin

private:
    /// Of each pixel: what the patch about it shows.
    struct Patches {
        cv::Mat1f correlations;
        cv::Mat1f own;  // mean square of the reference
        cv::Mat1f other;
        cv::Mat1f product;

        void compare(const cv::Mat1f& reference, const cv::Mat1f& present, int size, float bare);
    };

    int patch_;    // pixels on a side
    double blur_;  // pixels
    Patches patches_, details_;
    cv::Mat1f reference_, present_, broad_;
};

}  // namespace mimetic
