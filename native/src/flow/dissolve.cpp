// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/flow/dissolve.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>

#include "shared/gray.hpp"

namespace mimetic {
namespace {

constexpr int kWidth = 96;  // pixels of the small copies
constexpr int kPatch = 8;   // pixels on a side: as large as what a change of scene replaces
constexpr std::size_t kLeastPatches = 8;
constexpr float kLeastContrast = 16;  // grey levels^2 of a patch that shows anything
// Five webcam and drawn sources, dissolves of .7 s, talking people, cuts, hands, slides and dark seconds:
// `mimetic evaluate abuse`. Dissolves: correlation to .5, residual to .13, contrast to .67; a talking head
// .47 and more, and a contrast of .93.
constexpr double kUnlike = .5;         // correlation of patches that show something else
constexpr double kMostAlike = .55;     // mean correlation of the ends
constexpr double kLeastChanged = .1;   // share of the picture
constexpr double kMostResidual = .13;  // of the energy between the ends, that no weight explains
constexpr double kLeastStep = .08;     // of the weight, from a quarter to the next
constexpr double kLeastShare = .05;    // of a scene that shows
constexpr double kMostContrast = .8;   // of the middle frame, relative to the ends'
constexpr float kLeastGain = .05F;     // of light: what is darker shows nothing
constexpr int kSpans[] = {8, 16, 32, DissolveWatch::kLongest};  // frames between the ends

/// Weights of the later scene in quarters of a span, which grow steadily: where the line through them says
/// that both scenes show.
MixedFrames mixed_within(int span, const std::array<double, 5>& weights) {
    const double slope = (weights[3] - weights[1]) / 2;
    const double middle = (weights[1] + weights[2] + weights[3]) / 3;
    const double from = std::max(0., 2 - (middle - kLeastShare) / slope),
                 to = std::min(4., 2 + (1 - kLeastShare - middle) / slope);
    return {span - static_cast<int>(std::ceil(from * span / 4)),
            span - static_cast<int>(std::floor(to * span / 4))};
}

}  // namespace

std::optional<MixedFrames> DissolveWatch::add(const ColorView& image) {
    check_image_size(image.rows, image.cols, "the frame");
    cv::Mat1b small;
    const int height =
        std::max(kPatch, static_cast<int>(std::lround(double{kWidth} * image.rows / image.cols)));
    cv::resize(to_gray(image), small, {kWidth, height}, 0, 0, cv::INTER_AREA);
    Patches patches((height / kPatch) * (kWidth / kPatch), kPatch * kPatch);
    for (Eigen::Index row = 0; row < patches.rows(); ++row) {
        const int left = static_cast<int>(row) % (kWidth / kPatch) * kPatch;
        const int top = static_cast<int>(row) / (kWidth / kPatch) * kPatch;
        for (int i = 0; i < kPatch * kPatch; ++i) {
            patches(row, i) = small(top + i / kPatch, left + i % kPatch);
        }
        patches.row(row).array() -= patches.row(row).mean();
    }
    if (num_frames_ > 0 && patches.rows() != at(0).rows()) {
        throw InvalidInput("the frame has another shape than the one before");
    }
    if (frames_.size() <= static_cast<std::size_t>(kLongest)) {
        frames_.push_back(std::move(patches));
    } else {
        frames_[static_cast<std::size_t>(num_frames_ % (kLongest + 1))] = std::move(patches);
    }
    ++num_frames_;
    std::optional<MixedFrames> mixed;
    for (const int span : kSpans) {
        if (const auto one = span < num_frames_ ? find(span) : std::nullopt) {
            mixed = mixed ? MixedFrames{std::max(mixed->first, one->first), std::min(mixed->last, one->last)}
                          : *one;
        }
    }
    return mixed;
}

std::optional<MixedFrames> DissolveWatch::find(int span) const {
    const Patches &before = at(span), &after = at(0);
    const Eigen::ArrayXf energy_before = before.rowwise().squaredNorm(),
                         energy_after = after.rowwise().squaredNorm();
    const Eigen::ArrayXf products = (before.array() * after.array()).rowwise().sum();
    std::vector<Eigen::Index> changed, alike;
    double correlations = 0;
    for (Eigen::Index row = 0; row < before.rows(); ++row) {
        constexpr float kLeastEnergy = kLeastContrast * kPatch * kPatch;
        if (energy_before[row] > kLeastEnergy && energy_after[row] > kLeastEnergy) {
            const double correlation = products[row] / std::sqrt(energy_before[row] * energy_after[row]);
            correlations += correlation;
            (correlation < kUnlike ? changed : alike).push_back(row);
        }
    }
    const std::size_t num_shown = changed.size() + alike.size();
    if (num_shown < kLeastPatches || correlations > kMostAlike * static_cast<double>(num_shown) ||
        static_cast<double>(changed.size()) < kLeastChanged * static_cast<double>(before.rows())) {
        return {};
    }
    // Light dims or brightens what stayed with what changed: taken out, or a head that moves meanwhile lacks
    // the contrast that a mixture lacks
    const auto relit = [&](const Patches& frame) -> Patches {
        const float gain =
            alike.size() < kLeastPatches
                ? 1
                : std::sqrt(frame(alike, Eigen::all).squaredNorm() / before(alike, Eigen::all).squaredNorm());
        return frame(changed, Eigen::all) / std::max(gain, kLeastGain);
    };
    const Patches start = before(changed, Eigen::all), end = relit(after);
    const Patches change = end - start;
    const double energy = change.squaredNorm();
    std::array<double, 5> weights{0, 0, 0, 0, 1};
    double middle_energy = 0;
    for (int quarter = 1; quarter < 4; ++quarter) {
        const Patches between = relit(at(span - span * quarter / 4));
        const Patches moved = between - start;
        const double weight = moved.cwiseProduct(change).sum() / energy;
        if ((moved - static_cast<float>(weight) * change).squaredNorm() > kMostResidual * energy) {
            return {};
        }
        weights[static_cast<std::size_t>(quarter)] = weight;
        middle_energy = quarter == 2 ? between.squaredNorm() : middle_energy;
    }
    for (std::size_t i = 1; i < weights.size(); ++i) {
        if (weights[i] - weights[i - 1] < kLeastStep) {
            return {};
        }
    }
    const double usual = (1 - weights[2]) * start.squaredNorm() + weights[2] * end.squaredNorm();
    if (middle_energy > kMostContrast * usual) {
        return {};
    }
    return mixed_within(span, weights);
}

}  // namespace mimetic
