// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <mimetic/shared/image.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// Frames that mix two scenes, counted back from the last one added, which is 0.
struct MixedFrames {
    int first = 0, last = 0;  ///< the first one is the longer ago
};

/// Detects where one scene dissolves into another, frame by frame.
///
/// Within a dissolve each frame is a weighted mean of two pictures that have little in common. Three frames
/// between two others must be such means, of growing weights, where the picture has changed; and the middle
/// one must have less contrast than either end, as a mean of unlike pictures has, while what only moves keeps
/// its contrast. A fade to black or a change of light leaves the picture alike, and is none; where something
/// moves meanwhile, the light is taken out first, as the rest of the picture shows it.
class DissolveWatch {
public:
    static constexpr int kLongest = 64;  ///< frames between the ends that are compared at most

    /// The next frame; all of one size. Frames that turn out to mix two scenes, some of which may have been
    /// told of before; nothing if none do. Throws InvalidInput if the size changes.
    std::optional<MixedFrames> add(const ColorView& image);

private:
    /// Patches of a small copy of a frame: rows, without their mean.
    using Patches = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    std::optional<MixedFrames> find(int span) const;
    const Patches& at(int frames_back) const {
        return frames_[static_cast<std::size_t>((num_frames_ - 1 - frames_back) % (kLongest + 1))];
    }

    std::vector<Patches> frames_;  // of the last frames, in a ring
    long num_frames_ = 0;
};

}  // namespace mimetic
