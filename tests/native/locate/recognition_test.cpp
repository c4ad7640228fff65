// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/src/locate/recognition.hpp"

#include <gtest/gtest.h>

namespace mimetic {
namespace {

constexpr Look kPlainly{.8, .5};
constexpr Look kStranger{.8, .3};  // features in the same places, other skin

class RecognitionTest : public testing::Test {
protected:
    /// One frame as a tracker goes through it; whether it was accepted.
    bool see(const Look& look, bool is_in_doubt = false) {
        recognition.begin_frame(is_in_doubt);
        const bool is_face = recognition.accepts(look);
        if (is_face) {
            recognition.learn(look);
        }
        return is_face;
    }

    void follow(int num_frames) {
        for (int k = 0; k < num_frames; ++k) {
            ASSERT_TRUE(see(kPlainly));
        }
    }

    Recognition recognition;
};

TEST_F(RecognitionTest, RefusesDetailThatStaysOtherThanUsualInTheThirdFrame) {
    follow(20);
    EXPECT_TRUE(see(kStranger));
    EXPECT_TRUE(see(kStranger));
    EXPECT_FALSE(see(kStranger));
}

TEST_F(RecognitionTest, ForgivesABlurOfTwoFrames) {
    follow(20);
    for (int k = 0; k < 5; ++k) {
        EXPECT_TRUE(see({.7, .1}));
        EXPECT_TRUE(see({.7, .1}));
        EXPECT_TRUE(see(kPlainly));
    }
}

TEST_F(RecognitionTest, RefusesOtherDetailAtOnceAfterALossOrACut) {
    follow(20);
    EXPECT_FALSE(see(kStranger, true));
    EXPECT_TRUE(see(kPlainly, true));
}

TEST_F(RecognitionTest, AsksForMoreLikenessForHalfASecondAfterALoss) {
    constexpr Look kHalfCovered{.4, .5};
    EXPECT_TRUE(see(kHalfCovered));
    EXPECT_FALSE(see(kHalfCovered, true));
    for (int k = 0; k < 11; ++k) {
        EXPECT_FALSE(see(kHalfCovered)) << k;
    }
    EXPECT_TRUE(see(kHalfCovered));
}

TEST_F(RecognitionTest, KnowsNothingOfDetailBeforeItHasSeenTheFace) {
    EXPECT_TRUE(see({.8, .1}, true));
    EXPECT_TRUE(recognition.may_be_reference({.8, .1}));
}

TEST_F(RecognitionTest, DoesNotLearnFromWhatItDoubts) {
    follow(20);
    for (int k = 0; k < 300; ++k) {
        see({.4, .45});
        see({.8, .45}, true);
    }
    follow(1);
    recognition.begin_frame(false);
    recognition.end_doubt();
    EXPECT_FALSE(recognition.may_be_reference({.8, .39}));
    EXPECT_TRUE(recognition.may_be_reference(kPlainly));
}

TEST_F(RecognitionTest, ForgetsWhatOthersLookedLike) {
    constexpr Look kMixture{.8, .39}, kOther{.8, .32};
    follow(20);
    for (int k = 0; k < 20; ++k) {
        EXPECT_TRUE(see(kMixture));
    }
    EXPECT_TRUE(see(kOther, true));
    Recognition other;
    std::swap(recognition, other);
    follow(20);
    for (int k = 0; k < 20; ++k) {
        see(kMixture);
    }
    recognition.forget(20);
    EXPECT_FALSE(see(kOther, true));
    EXPECT_TRUE(see(kPlainly, true));
}

TEST_F(RecognitionTest, AsksForAReferencesDetailAfterALoss) {
    constexpr Look kBetween{.8, .39};  // .78 of the usual
    follow(20);
    EXPECT_TRUE(see(kBetween));
    EXPECT_TRUE(see(kBetween));
    EXPECT_TRUE(see(kBetween));
    EXPECT_FALSE(see(kBetween, true));
}

// Two faces that dissolve into each other: less of it is alike, and that has less detail.
TEST_F(RecognitionTest, CountsDetailForLessTheLessOfTheFaceIsAlike) {
    constexpr Look kMixture{.55, .4}, kUnderAHand{.6, .5};
    const auto refused_in = [&](Recognition standards, const Look& look) {
        recognition = standards;
        follow(20);
        int frame = 1;
        while (frame < 9 && see(look)) {
            ++frame;
        }
        return frame;
    };
    EXPECT_EQ(refused_in(Recognition(.62, .66, .75), kMixture), 3);
    EXPECT_EQ(refused_in(Recognition(.62, .66), kMixture), 9);
    EXPECT_EQ(refused_in(Recognition(.62, .66, .75), kUnderAHand), 9);
}

}  // namespace
}  // namespace mimetic
