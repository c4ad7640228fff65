// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

#include "reference_view.hpp"

namespace mimetic {

/// How much of what is in sight looks, patch by patch, as the reference texture does in the same place.
///
/// No flow may bend the picture first: with it, grass and other people's faces fit half of any texture, and
/// covers fit at their edges. Patches are compared one by one, so that what covers the face costs no more
/// than it hides, and by correlation, so that light may change.
class Likeness {
public:
    /// texture: the frame under a hypothesis, as ReferenceView::stabilise gives it; visible: of each sample.
    /// Returns the share of the texture in sight that is alike, 0 to 1; 0 where nothing is in sight.
    double compare(const ReferenceView& view, const cv::Mat1f& texture, const std::vector<float>& visible);

    /// Of each sample of the last comparison: normalised correlation of its patch, -1 to 1; 0 out of sight.
    const std::vector<float>& correlations() const { return correlations_; }

    static constexpr float kAlike = .5f;  ///< correlation of a patch that shows the same skin

private:
    std::vector<float> correlations_;
    cv::Mat1f reference_, present_, product_, ab_, aa_, bb_;
};

}  // namespace mimetic
