// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mimetic/flow/dissolve.hpp>
#include <mimetic/shared/error.hpp>
#include <set>

#include "textures.hpp"

namespace mimetic {
namespace {

constexpr int kRows = 54, kCols = 96;
constexpr int kNumFrames = 60;
constexpr int kStart = 20, kEnd = 40;  // of what happens

/// Scenes that have nothing in common, seen by a camera that pans; shift: pixels.
class DissolveTest : public ::testing::Test {
protected:
    using Pixels = std::vector<std::uint8_t>;

    static Pixels scene(unsigned seed, double shift) {
        const auto texture = testing::make_texture(seed, 40);
        Pixels pixels;
        pixels.reserve(std::size_t{3} * kRows * kCols);
        for (int y = 0; y < kRows; ++y) {
            for (int x = 0; x < kCols; ++x) {
                const double value = std::clamp(std::round(texture(x + shift, y)), 0., 255.);
                pixels.insert(pixels.end(), 3, static_cast<std::uint8_t>(value));
            }
        }
        return pixels;
    }

    static Pixels mixed(const Pixels& a, const Pixels& b, double share) {
        Pixels result = a;
        for (std::size_t i = 0; i < a.size(); ++i) {
            result[i] = static_cast<std::uint8_t>(std::lround((1 - share) * a[i] + share * b[i]));
        }
        return result;
    }

    static double share_at(int frame) { return std::clamp((frame - kStart) / double(kEnd - kStart), 0., 1.); }

    /// Frames that are said to mix two scenes.
    template <typename Picture>
    std::set<int> mixed_frames(const Picture& picture_of) {
        std::set<int> frames;
        for (int frame = 0; frame < kNumFrames; ++frame) {
            const Pixels pixels = picture_of(frame);
            if (const auto mixed = watch.add({pixels.data(), kRows, kCols, 3 * kCols})) {
                for (int back = mixed->last; back <= mixed->first; ++back) {
                    frames.insert(frame - back);
                }
            }
        }
        return frames;
    }

    DissolveWatch watch;
};

TEST_F(DissolveTest, TellsWhichFramesMixTwoScenes) {
    const auto frames = mixed_frames(
        [](int frame) { return mixed(scene(1, .1 * frame), scene(2, -.1 * frame), share_at(frame)); });
    ASSERT_FALSE(frames.empty());
    EXPECT_NEAR(*frames.begin(), kStart + 1, 2);
    EXPECT_NEAR(*frames.rbegin(), kEnd - 1, 2);
    EXPECT_EQ(static_cast<int>(frames.size()), *frames.rbegin() - *frames.begin() + 1);
}

TEST_F(DissolveTest, TakesMotionForNone) {
    for (const double speed : {.1, .5, 2., 6.}) {
        watch = {};
        EXPECT_TRUE(mixed_frames([&](int frame) { return scene(1, speed * frame); }).empty()) << speed;
    }
}

TEST_F(DissolveTest, TakesACutForNone) {
    EXPECT_TRUE(mixed_frames([](int frame) { return scene(frame < 30 ? 1 : 2, .1 * frame); }).empty());
}

TEST_F(DissolveTest, TakesAFadeToBlackAndALampForNone) {
    const Pixels black(std::size_t{3} * kRows * kCols, 16), white(std::size_t{3} * kRows * kCols, 235);
    for (const Pixels& other : {black, white}) {
        watch = {};
        EXPECT_TRUE(mixed_frames([&](int frame) {
                        return mixed(scene(1, .1 * frame), other, .9 * share_at(frame));
                    }).empty());
    }
}

/// A left part of two thirds before a background that stays.
template <typename Part>
std::vector<std::uint8_t> in_front(const std::vector<std::uint8_t>& background, const Part& part) {
    std::vector<std::uint8_t> pixels = background;
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < 2 * kCols / 3; ++x) {
            const double value = std::clamp(std::round(part(x, y)), 0., 255.);
            std::fill_n(pixels.begin() + 3 * (y * kCols + x), 3, static_cast<std::uint8_t>(value));
        }
    }
    return pixels;
}

TEST_F(DissolveTest, TakesLightThatChangesOnWhatMovesForNone) {
    const Pixels background = scene(1, 0), dark(background.size(), 16);
    for (const double before : {1., .6}) {  // of the light, which the other follows at once or over 6 frames
        for (const int duration : {1, 6}) {
            watch = {};
            const auto frames = mixed_frames([&](int frame) {
                const auto moving = [frame](double x, double y) {
                    return 128 + 50 * std::sin(2 * M_PI * (x + .6 * y + .4 * frame) / 20);
                };
                const double changed = std::clamp((frame - 29.) / duration, 0., 1.);
                const double light = before + changed * (1.6 - 2 * before);
                return mixed(dark, in_front(background, moving), light);
            });
            EXPECT_TRUE(frames.empty()) << before << " of the light at first, over " << duration;
        }
    }
}

TEST_F(DissolveTest, TellsADissolveBesideWhatStays) {
    const auto first = testing::make_texture(2, 40), second = testing::make_texture(3, 40);
    const auto frames = mixed_frames([&](int frame) {
        return in_front(scene(1, 0), [&](double x, double y) {
            return (1 - share_at(frame)) * first(x, y) + share_at(frame) * second(x, y);
        });
    });
    ASSERT_FALSE(frames.empty());
    EXPECT_NEAR(*frames.begin(), kStart + 1, 2);
    EXPECT_NEAR(*frames.rbegin(), kEnd - 1, 2);
}

TEST_F(DissolveTest, RefusesFramesOfAnotherShape) {
    const Pixels pixels = scene(1, 0);
    watch.add({pixels.data(), kRows, kCols, 3 * kCols});
    EXPECT_THROW(watch.add({pixels.data(), kRows, kCols / 2, 3 * kCols}), InvalidInput);
}

}  // namespace
}  // namespace mimetic
