// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "cover.hpp"
#include "opening_evidence.hpp"

namespace mimetic {

/// Evidence at eyes and mouth, beside flow, which cannot track what opens and closes.
class FeatureEvidence {
public:
    /// image: the reference frame, in which the face is at rest at this state.
    FeatureEvidence(const TrackedFace& face, const FeatureInputs& inputs, const ColorView& image,
                    const FaceState& at_rest);

    /// The reference frame's state: at rest, the lids as they are in it.
    const FaceState& reference() const { return reference_; }

    /// Looks at a frame in which the face is about at this state.
    void look(const ColorView& image, const FaceState& near);
    void look_away();  ///< nothing is known until the next look

    /// Forgets the openings of the last look that something is before.
    void leave_out(const Cover& cover);

    /// The evidence, linearised at a state.
    StepPrior terms(const FaceState& state) const;

    /// The evidence of detail at a state, which the lines bound as they do the values: the flow about an
    /// opening, alone, would part lips that were seen to touch.
    DetailTerms detail_terms(const FaceState& state) const;

    /// The irises of the last look, the left first.
    std::array<SeenIris, 2> irises() const;

    /// The state with the lids where they were seen: a blink is over before flow could follow it.
    FaceState with_lids(FaceState state) const;

private:
    const TrackedFace& face_;
    FeatureSource source_;
    std::vector<OpeningEvidence> openings_;
    double interpupillary_ = 0;
    std::vector<SeenOpening> seen_;
    FaceState reference_;
};

}  // namespace mimetic
