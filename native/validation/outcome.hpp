// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "benchmark.hpp"

namespace mimetic::validation {

struct Outcome {
    std::vector<double> values;  ///< one a mesh
    std::vector<double> errors;  ///< the same over the reference, less one; the value itself if that is 0
    double stated_error = 0;
    bool is_within = false;    ///< the stated mesh's error is within the limit
    bool is_monotone = false;  ///< every refinement lowers the error, until it is under 0.1 %

    bool passed() const { return is_within && is_monotone; }
};

inline Outcome judge(const Benchmark& benchmark, std::vector<double> values) {
    constexpr double kSettled = 1e-3;
    Outcome outcome;
    outcome.is_monotone = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double error = benchmark.reference == 0 ? values[i] : values[i] / benchmark.reference - 1;
        const bool falls = i == 0 || std::abs(error) < std::abs(outcome.errors.back());
        outcome.is_monotone = outcome.is_monotone && (falls || std::abs(error) < kSettled);
        outcome.errors.push_back(error);
        if (benchmark.meshes[i] == benchmark.stated_mesh) {
            outcome.stated_error = error;
            outcome.is_within = std::abs(error) <= benchmark.limit;
        }
    }
    outcome.values = std::move(values);
    return outcome;
}

}  // namespace mimetic::validation
