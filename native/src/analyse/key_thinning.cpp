// SPDX-License-Identifier: GPL-3.0-or-later
#include "key_thinning.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "key_fit.hpp"

namespace mimetic {
namespace {

/// A part of a curve between two keys that no other part depends on, and its keys.
class Stretch {
public:
    Stretch(VectorIn frames, VectorIn values, const CurveExtent& extent, double tolerance)
        : frames_(frames), values_(values), extent_(extent), tolerance_(tolerance) {}

    /// Takes away keys, and moves the others a little, as long as the curve stays within the tolerance.
    /// rows: the stretch's, its first and last included; those of `fixed` stay.
    void thin_out(std::set<int>& rows, const std::set<int>& fixed) const {
        while (take_one_away(rows, fixed)) {
        }
    }

private:
    static constexpr std::size_t kCandidates = 4;  // of those that are missed least
    static constexpr int kRounds = 3;              // of moving each key
    static constexpr double kHopeless = 4;         // times the tolerance: moving does not make up for that

    /// Whether one of the keys could be spared.
    bool take_one_away(std::set<int>& rows, const std::set<int>& fixed) const {
        std::vector<std::pair<double, int>> candidates;
        for (const int row : rows) {
            if (!fixed.contains(row) && row != *rows.begin() && row != *rows.rbegin()) {
                std::set<int> fewer = rows;
                fewer.erase(row);
                candidates.emplace_back(error_of(fewer), row);
            }
        }
        std::sort(candidates.begin(), candidates.end());
        candidates.resize(std::min(candidates.size(), kCandidates));
        for (const auto& [error, row] : candidates) {
            std::set<int> fewer = rows;
            fewer.erase(row);
            if (moved_within(fewer, fixed, error) <= tolerance_) {
                rows = std::move(fewer);
                return true;
            }
        }
        return false;
    }

    double error_of(const std::set<int>& rows) const {
        return fit_keys(frames_, values_, rows, extent_, tolerance_).error;
    }

    /// The error after moving keys to where it is least, as far as it takes to be within the tolerance.
    double moved_within(std::set<int>& rows, const std::set<int>& fixed, double error) const {
        if (error > kHopeless * tolerance_) {
            return error;
        }
        for (int round = 0; round < kRounds && error > tolerance_; ++round) {
            const double before = error;
            const std::vector<int> movable(std::next(rows.begin()), std::prev(rows.end()));
            for (const int row : movable) {
                if (fixed.contains(row)) {
                    continue;
                }
                std::set<int> best = rows;
                for (const int step : {-2, -1, 1, 2}) {
                    if (std::set<int> other = rows; move(other, row, step)) {
                        if (const double now = error_of(other); now < error) {
                            error = now;
                            best = std::move(other);
                        }
                    }
                }
                rows = std::move(best);
            }
            if (error > .98 * before) {
                break;
            }
        }
        return error;
    }

    /// Whether a key can be moved without meeting or passing another.
    static bool move(std::set<int>& rows, int row, int step) {
        const auto at = rows.find(row);
        if (at == rows.end() || *std::prev(at) >= row + step || *std::next(at) <= row + step) {
            return false;
        }
        rows.erase(at);
        rows.insert(row + step);
        return true;
    }

    Eigen::VectorXd frames_, values_;
    CurveExtent extent_;
    double tolerance_;
};

}  // namespace

void thin_out(VectorIn frames, VectorIn values, double tolerance, std::set<int>& rows,
              const std::set<int>& fixed) {
    const CurveExtent extent(values);
    std::set<int> kept;
    auto begin = rows.begin();
    while (begin != rows.end()) {
        auto end = std::next(begin);
        while (end != rows.end() && std::next(end) != rows.end() && !extent.rests(values[*end], tolerance)) {
            ++end;
        }
        if (end == rows.end()) {
            kept.insert(*begin);
            break;
        }
        const int first = *begin, length = *end - first + 1;
        std::set<int> own, own_fixed;
        for (auto row = begin; row != std::next(end); ++row) {
            own.insert(*row - first);
            if (fixed.contains(*row)) {
                own_fixed.insert(*row - first);
            }
        }
        Stretch(frames.segment(first, length), values.segment(first, length), extent, tolerance)
            .thin_out(own, own_fixed);
        for (const int row : own) {
            kept.insert(row + first);
        }
        begin = end;
    }
    rows = std::move(kept);
}

}  // namespace mimetic
