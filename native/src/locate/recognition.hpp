// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>

#include "likeness.hpp"

namespace mimetic {

/// Whether a tracker still sees the face that it has tracked so far.
///
/// A share of its texture must be alike: of a tracked face .7 to .9 is, under a hand that hides half of it
/// .5; of walls, grass and bars .0 to .15, of a stranger's features laid on this face's mostly below .3. And
/// its detail must be as this clip has usually shown it, by which strangers whose features fit are known: how
/// much detail comes back depends on camera and encoder, but hardly changes within a clip. In what is blurred
/// for a frame or two it is missing, so that is not enough to doubt. Figures: `mimetic evaluate abuse`,
/// docs/measured/evaluation.md.
class Recognition {
public:
    static constexpr double kPlain = .6;  ///< share below which something covers the face

    /// Shares of the usual detail: what this face has at least, and what a reference texture must have, and
    /// what is asked for after a loss or a cut. alike_throughout: share that a face is alike which nothing
    /// covers; below it detail counts for less, as of two faces that dissolve into each other both fall. 0:
    /// detail counts for what it is.
    explicit Recognition(double same_detail = .76, double good_detail = .8, double alike_throughout = 0)
        : same_detail_(same_detail), good_detail_(good_detail), alike_throughout_(alike_throughout) {}

    /// Begins a frame. is_in_doubt: the face was lost, or the tracker is not sure that it is still there.
    void begin_frame(bool is_in_doubt);
    /// For half a second it must be surely this face: after a loss or a cut another one may be in its place.
    void begin_trial() { trial_ = kTrial; }
    /// The face is known to be there.
    void end_doubt();

    bool accepts(const Look& look) const;
    /// Whether the frame shows this face well enough for a reference texture, which would confirm whatever
    /// looks like it.
    bool may_be_reference(const Look& look) const;
    /// The look of a frame that was accepted.
    void learn(const Look& look);
    /// Forgets the looks of the last `num_last` frames: they showed something else.
    void forget(int num_last);

    bool is_on_trial() const { return trial_ > 0; }
    /// The trial began in this frame.
    bool has_trial_begun() const { return trial_ == kTrial; }

private:
    static constexpr int kTrial = 12;  // frames: half a second
    bool lacks_detail(const Look& look, double least_share) const;

    double same_detail_, good_detail_, alike_throughout_;
    int trial_ = 0;
    int num_strange_ = 0;  // consecutive frames that lacked detail
    struct Learnt {
        long frame;
        double detail;
    };
    void know_usual_detail();

    long frame_ = 0;
    std::deque<Learnt> learnt_;  // of the last frames that were plainly this face
    double usual_detail_ = 0;
};

}  // namespace mimetic
