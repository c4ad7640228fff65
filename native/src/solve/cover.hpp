// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/solve/features.hpp>

namespace mimetic {

/// What is before the face: in a frame, and in the reference frame, whose texture shows it in place of skin.
/// What was less than sure there, as a beard that is mistaken for cover, is usual and hides nothing.
class Cover {
public:
    /// image: the reference frame, with the head at a pose. Without a source nothing is ever covered.
    /// still: what stands still in the picture in all frames, the reference frame among them.
    Cover(OcclusionSource source, StillCover still, const ColorView& image,
          const Eigen::Isometry3d& camera_from_head);

    /// Looks at a frame with the head about at a pose.
    void look(const ColorView& image, const Eigen::Isometry3d& camera_from_head);
    void look_away();  ///< nothing is covered until the next look
    void dismiss();    ///< nothing came: it was a mistake

    /// Whether there is any pixel that it hides.
    bool hides_any() const;

    /// Whether at a pixel of the frame that was last looked at no skin is compared with skin.
    bool hides(const Eigen::Vector2d& pixel) const {
        return stands(pixel) || came(pixel) || was_hidden(pixel);
    }

    /// Whether something stands still in the picture there, before whatever the frame shows.
    bool stands(const Eigen::Vector2d& pixel) const { return still_.at(pixel); }

    /// Whether something is before the face there that was not in the reference frame.
    bool came(const Eigen::Vector2d& pixel) const;

    /// Whether the texture there shows what was before the face in the reference frame.
    bool was_hidden(const Eigen::Vector2d& pixel) const;

private:
    OcclusionSource source_;
    StillCover still_;
    Eigen::MatrixXf usual_;  // as the reference frame's cells, each with those about it
    Eigen::MatrixXf first_;  // 1 where something was surely before the reference frame's face, or still is
    Occlusion seen_;         // beyond what is usual
    Occlusion behind_;       // `first_`, on the square of the last look
};

/// The share of points (K x 2, pixels) for which something holds.
template <typename Holds>
double share_of(const Points2& points, const Holds& holds) {
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        count += holds(Eigen::Vector2d(points.row(i).transpose())) ? 1 : 0;
    }
    return points.rows() > 0 ? static_cast<double>(count) / static_cast<double>(points.rows()) : 0;
}

}  // namespace mimetic
