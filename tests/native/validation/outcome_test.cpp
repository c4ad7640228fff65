// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../../native/validation/outcome.hpp"

#include <gtest/gtest.h>

namespace mimetic::validation {
namespace {

Outcome judged(double reference, const std::vector<double>& values) {
    Benchmark benchmark;
    benchmark.reference = reference;
    benchmark.meshes = {8, 16, 32};
    benchmark.stated_mesh = 16;
    return judge(benchmark, values);
}

TEST(Outcome, HoldsWithinTheLimitAndFalling) {
    const Outcome outcome = judged(2, {1.8, 1.96, 1.99});
    EXPECT_TRUE(outcome.passed());
    EXPECT_NEAR(outcome.stated_error, -0.02, 1e-12);
}

TEST(Outcome, FailsOffTheLimitAtTheStatedMesh) {
    EXPECT_FALSE(judged(2, {1.8, 1.9, 2}).is_within);
    EXPECT_FALSE(judged(2, {2.5, 2.1, 2}).is_within);
}

TEST(Outcome, FailsWhenRefinementMakesItWorse) {
    EXPECT_FALSE(judged(2, {1.99, 1.98, 2}).is_monotone);
    EXPECT_FALSE(judged(2, {1.9, 1.98, 2.03}).is_monotone);
    EXPECT_TRUE(judged(2, {1.9, 2, 2.001}).is_monotone);  // settled
}

TEST(Outcome, FailsOnNaN) {
    EXPECT_FALSE(judged(2, {1.9, std::nan(""), 2}).passed());
    EXPECT_FALSE(judged(2, {1.9, 1.98, std::nan("")}).is_monotone);
}

TEST(Outcome, AReferenceOfZeroTakesTheValueAsTheError) {
    EXPECT_TRUE(judged(0, {1e-15, 1e-15, 2e-15}).passed());
    EXPECT_FALSE(judged(0, {1e-15, 0.1, 1e-15}).passed());
}

}  // namespace
}  // namespace mimetic::validation
