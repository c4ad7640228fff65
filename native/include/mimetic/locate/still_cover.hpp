// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>

namespace mimetic {

struct FaceFeatures;

/// What is before the face and stays where it is in the picture while the head moves, as captions, logos,
/// watermarks and a microphone on its stand do: square cells of the picture that it is in.
struct StillCover {
    using Cells = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

    Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< top left of the first cell, pixels
    double cell = 1;                                   ///< side of a cell, pixels
    Cells cells;                                       ///< rows downward; none: there is no such cover

    bool any() const { return cells.size() > 0; }
    bool at(const Eigen::Vector2d& pixel) const;  ///< false beside the cells
    void check() const;                           ///< throws InvalidInput: field, value, limit
};

/// Finds such cover by edges that most frames have at the same place of the picture, and that the face itself
/// has nowhere: what goes with the head is no cover, whatever it looks like. Where the head hardly moves
/// nothing can be told. A frame takes less than a megabyte.
class StillCoverWatch {
public:
    StillCoverWatch();
    ~StillCoverWatch();
    StillCoverWatch(StillCoverWatch&&) noexcept;
    StillCoverWatch& operator=(StillCoverWatch&&) noexcept;

    /// A frame, some of a clip's of one size, and the face that was found in it. Throws InvalidInput.
    void add(const ColorView& image, const FaceFeatures& face);

    /// What the frames so far tell; none from fewer than six.
    StillCover found() const;

private:
    struct Looks;
    std::unique_ptr<Looks> looks_;
};

}  // namespace mimetic
