// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace mimetic::test {

#ifdef __SANITIZE_ADDRESS__
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

/// How often the same code runs: `part` under the sanitizers, where all takes some ten times as long and
/// which see an error at once; `whole` in the release build, where the many runs are what a claim is about.
constexpr int repeats(int whole, int part) { return kIsSanitized ? part : whole; }

}  // namespace mimetic::test
