// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>
#include <optional>

namespace mimetic {

/// The odd number of pixels next to a length: of a window with a pixel in its middle.
int odd(double pixels);

/// How a picture compares with a reference texture.
struct Look {
    double alike = 0;   ///< share of the visible texture that matches, patch by patch; 0 to 1
    double detail = 0;  ///< mean correlation of the finest detail in those patches, -1 to 1
};

/// Coarse structure and fine detail of a texture, and of each pixel the mean squares of the patches about it.
struct FilteredTexture {
    double face_height = 0;  ///< that it is made for, pixels
    cv::Mat1f coarse, detail, coarse_squares, detail_squares;
};

/// A texture without light and contrast, of a mean of 0 and some 40 grey levels deviation, with which others
/// are compared. What a comparison needs of it is made in the first one, and kept.
class ReferenceTexture {
public:
    ReferenceTexture() = default;
    explicit ReferenceTexture(const cv::Mat1f& values) : values_(values.clone()) {}

    const cv::Mat1f& values() const { return values_; }

private:
    friend class Likeness;

    cv::Mat1f values_;
    mutable std::optional<FilteredTexture> filtered_;
};

/// Share of the visible texture that matches, patch by patch, the reference texture in the same place.
///
/// The picture must not be warped by flow first: grass and other people's faces would then fit half of any
/// texture, and occluders at their edges. Patches are compared one by one, so that an occluder costs no more
/// than it hides, and by correlation, so that light may change. All faces have eyes, mouth and nose in the
/// same places; they differ in detail.
class Likeness {
public:
    /// face_height: pixels of the face in the textures, chin to brows and forehead.
    explicit Likeness(double face_height);

    /// present: another texture like the reference; weights: of each pixel, 0 out of sight; all of one size.
    /// 0 where nothing is visible.
    Look compare(const ReferenceTexture& reference, const cv::Mat1f& present, const cv::Mat1f& weights);

    /// Of each pixel of the last comparison: normalised correlation of its patch, -1 to 1.
    const cv::Mat1f& correlations() const { return correlations_; }

    static constexpr float kAlike = .5f;  ///< correlation of a patch that shows the same skin

private:
    void filter(const cv::Mat1f& texture, FilteredTexture& filtered);
    void mean_products(const cv::Mat1f& a, const cv::Mat1f& b, int patch, cv::Mat1f& means);

    double face_height_;
    int patch_;            // pixels on a side
    double blur_;          // pixels
    double detail_scale_;  // of the lengths by which detail is defined
    cv::Mat1f correlations_, detail_correlations_;
    FilteredTexture present_;
    cv::Mat1f broad_, product_;
};

}  // namespace mimetic
