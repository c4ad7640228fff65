// SPDX-License-Identifier: GPL-3.0-or-later
#include "recognition.hpp"

#include <algorithm>
#include <vector>

namespace mimetic {

namespace {

constexpr double kStillAlike = .3;   // share to be followed on
constexpr double kSurelyAlike = .5;  // share to be taken for the face after a loss or a cut
constexpr int kPatience = 3;         // consecutive frames without detail that are more than a blur
constexpr double kUsual = .2;        // share of the frames with less than the usual detail: those that lie
                                     // next to a reference texture have more of it
constexpr std::size_t kLeastLearnt = 6;   // frames until the usual detail is known
constexpr std::size_t kMostLearnt = 250;  // frames, ten seconds, from which it is known

}  // namespace

void Recognition::begin_frame(bool is_in_doubt) {
    trial_ = is_in_doubt ? kTrial : std::max(0, trial_ - 1);
    ++frame_;
}

void Recognition::end_doubt() {
    trial_ = 0;
    num_strange_ = 0;
}

bool Recognition::lacks_detail(const Look& look, double least_share) const {
    const double whole = look.alike < alike_throughout_ ? look.alike / alike_throughout_ : 1;
    return learnt_.size() >= kLeastLearnt && whole * look.detail < least_share * usual_detail_;
}

bool Recognition::accepts(const Look& look) const {
    if (look.alike < (is_on_trial() ? kSurelyAlike : kStillAlike)) {
        return false;
    }
    if (is_on_trial()) {
        return !lacks_detail(look, good_detail_);
    }
    return num_strange_ + 1 < kPatience || !lacks_detail(look, same_detail_);
}

bool Recognition::may_be_reference(const Look& look) const {
    return look.alike >= kSurelyAlike && !lacks_detail(look, good_detail_);
}

void Recognition::learn(const Look& look) {
    num_strange_ = lacks_detail(look, same_detail_) ? num_strange_ + 1 : 0;
    if (num_strange_ > 0 || is_on_trial() || look.alike < kPlain) {
        return;
    }
    learnt_.push_back({frame_, look.detail});
    if (learnt_.size() > kMostLearnt) {
        learnt_.pop_front();
    }
    know_usual_detail();
}

void Recognition::forget(int num_last) {
    while (!learnt_.empty() && learnt_.back().frame > frame_ - num_last) {
        learnt_.pop_back();
    }
    know_usual_detail();
}

void Recognition::know_usual_detail() {
    if (learnt_.empty()) {
        return;
    }
    std::vector<double> ordered(learnt_.size());
    std::transform(learnt_.begin(), learnt_.end(), ordered.begin(),
                   [](const Learnt& one) { return one.detail; });
    const auto usual = ordered.begin() + static_cast<std::ptrdiff_t>(kUsual * double(ordered.size()));
    std::nth_element(ordered.begin(), usual, ordered.end());
    usual_detail_ = *usual;
}

}  // namespace mimetic
