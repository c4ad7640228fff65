// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Rotation vectors of the left and the right eye, radians.
using EyeTurns = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

/// One channel of a bone of a character's rig: what turns with it, or looks at where it goes.
struct EyeChannel {
    int bone = 0;         ///< which one it is of: channels of one bone are used together
    bool is_aim = false;  ///< the eye looks at the bone, which moves: values are as the tangent of turns
    EyeTurns turns = EyeTurns::Zero();  ///< at value 1, near rest, in the frame of the mesh
};

/// A channel's turns at value 1, of eyes that turned so from value -step to step.
EyeTurns eye_rates(const EyeTurns& turned, bool is_aim, double step);

/// N x 3: rotation vectors of eyes that look ahead at rest, the shortest way. yaw, pitch: N degrees, to the
/// subject's left and up, in a frame with x to its left, z up, the face towards -y.
Points gaze_turns(VectorIn yaw, VectorIn pitch);

/// Values of channels that turn eyes. Gaze is not fitted to a surface as other controls are: an eyeball's
/// says nothing of where it looks.
class EyeChannels {
public:
    /// ahead: where eyes look at rest; eyes: which there are, among 0 (left) and 1. Throws InvalidInput.
    EyeChannels(std::vector<EyeChannel> channels, const Eigen::Vector3d& ahead, std::vector<int> eyes);

    /// T x K for turns of both eyes (T x 6, rotation vectors): each eye by the one bone that turns it best
    /// and no other, both by one that they share where an eye has none; 0 for all other channels. Throws
    /// InvalidInput.
    MatrixRows values(const Eigen::Ref<const MatrixRows>& turns) const;

    /// Eyes that no channel turns.
    std::vector<int> undriven() const;

private:
    struct Choice {
        std::vector<int> eyes, channels;
    };
    std::vector<int> best(const std::vector<int>& eyes) const;
    bool turns_only(const EyeChannel& channel, const std::vector<int>& eyes) const;

    std::vector<EyeChannel> channels_;
    Eigen::Vector3d ahead_;
    std::vector<int> eyes_;
    std::vector<Choice> choices_;
};

}  // namespace mimetic
