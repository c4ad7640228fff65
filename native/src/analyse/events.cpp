// SPDX-License-Identifier: GPL-3.0-or-later
#include "events.hpp"

#include <algorithm>

#include "shared/robust.hpp"

namespace mimetic {
namespace {

constexpr int kRestAround = 8;      // rows of rest that an event keeps on each side
constexpr double kAtRest = .1;      // of the height above the valley
constexpr double kCut = .3;         // of the height: an end of the clip above it cuts the event
constexpr double kHeld = .6;        // of the height, in a hold
constexpr int kLongHold = 12;       // rows
constexpr int kLongestEvent = 900;  // rows
constexpr double kOneApart = 1.5;   // of the usual step from row to row

int lowest(VectorIn values, int first, int last) {
    int row = first;
    for (int i = first; i <= last; ++i) {
        if (values[i] < values[row]) {
            row = i;
        }
    }
    return row;
}

struct Peak {
    int row;
    int valley_before, valley_after;
};

/// The peak with the least drop to its higher valley, relative to what is asked; -1 if all fall far enough.
int weakest(const std::vector<Peak>& peaks, VectorIn values, double base, const PhaseOptions& options) {
    int weakest = -1;
    double least = 1;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        const double top = values[peaks[i].row];
        const bool alone = peaks.size() == 1;
        const double valley = alone ? std::min(values[peaks[i].valley_before], values[peaks[i].valley_after])
                                    : std::max(i > 0 ? values[peaks[i].valley_before] : base,
                                               i + 1 < peaks.size() ? values[peaks[i].valley_after] : base);
        const double wanted = std::max(options.least_amplitude, options.least_drop * (top - base));
        const double drop = (top - valley) / wanted;
        if (drop < least) {
            least = drop;
            weakest = static_cast<int>(i);
        }
    }
    return weakest;
}

/// is_first, is_last: among the peaks of its stretch of rows.
EventRows around(const Peak& peak, VectorIn values, int first_row, int last_row, bool is_first,
                 bool is_last) {
    EventRows event{peak.valley_before, peak.valley_after, peak.row};
    const double top = values[peak.row];
    const double base = std::min(values[peak.valley_before], values[peak.valley_after]);
    const auto is_high = [&](int row) { return values[row] - base > kCut * (top - base); };
    const auto rests = [&](int row, int valley) {
        return values[row] - values[valley] <= kAtRest * (top - values[valley]);
    };
    int begin = peak.row, end = peak.row;
    while (begin > peak.valley_before && !rests(begin, peak.valley_before)) {
        --begin;
    }
    while (end < peak.valley_after && !rests(end, peak.valley_after)) {
        ++end;
    }
    event.first = std::max({first_row, peak.valley_before, begin - kRestAround});
    event.last = std::min({last_row, peak.valley_after, end + kRestAround});
    // What is held to the end of a stretch has a dip of noise for its valley there, and rests nowhere
    if (is_first && is_high(peak.valley_before)) {
        event.first = first_row;
    }
    if (is_last && is_high(peak.valley_after)) {
        event.last = last_row;
    }
    const int first = event.first, last = event.last;
    if (last - first > kLongestEvent) {  // of a longer one what is about its peak
        event.first = std::max(first, std::min(peak.row - kLongestEvent / 2, last - kLongestEvent));
        event.last = event.first + kLongestEvent;
    }
    int held = 0;
    for (int row = event.first; row <= event.last; ++row) {
        held += values[row] - values[peak.valley_before] > kHeld * (top - values[peak.valley_before]);
    }
    event.is_long = held >= kLongHold;
    event.begins_before = (event.first == first_row || event.first > first) && is_high(event.first);
    event.ends_after = (event.last == last_row || event.last < last) && is_high(event.last);
    return event;
}

void find_in(VectorIn values, int first, int last, const PhaseOptions& options,
             std::vector<EventRows>& events) {
    std::vector<Peak> peaks;
    for (int i = first; i <= last; ++i) {
        const bool rises = i == first || values[i] > values[i - 1];
        int end = i;
        while (end < last && values[end + 1] == values[i]) {
            ++end;
        }
        if (rises && (end == last || values[end + 1] < values[i])) {
            peaks.push_back({(i + end) / 2, first, last});
        }
        i = end;
    }
    const auto set_valleys = [&] {
        for (std::size_t i = 0; i + 1 < peaks.size(); ++i) {
            peaks[i].valley_after = peaks[i + 1].valley_before =
                lowest(values, peaks[i].row, peaks[i + 1].row);
        }
        if (!peaks.empty()) {
            peaks.front().valley_before = lowest(values, first, peaks.front().row);
            peaks.back().valley_after = lowest(values, peaks.back().row, last);
        }
    };
    const double base = values.segment(first, last - first + 1).minCoeff();
    set_valleys();
    for (int weak = weakest(peaks, values, base, options); weak >= 0;
         weak = weakest(peaks, values, base, options)) {
        peaks.erase(peaks.begin() + weak);
        set_valleys();
    }
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        const EventRows event = around(peaks[i], values, first, last, i == 0, i + 1 == peaks.size());
        if (event.last - event.first >= 5) {
            events.push_back(event);
        }
    }
}

}  // namespace

std::vector<Stretch> stretches(VectorIn frames, const std::vector<double>& scene_starts) {
    std::vector<Stretch> found;
    const int count = static_cast<int>(frames.size());
    std::vector<double> steps;
    for (int row = 1; row < count; ++row) {
        steps.push_back(frames[row] - frames[row - 1]);
    }
    const double apart = kOneApart * median(std::move(steps));  // a scene may have several frames a row
    for (int first = 0; first < count;) {
        int last = first;
        const auto is_cut = [&](double start) { return start > frames[last] && start <= frames[last + 1]; };
        while (last + 1 < count && frames[last + 1] - frames[last] < apart &&
               std::none_of(scene_starts.begin(), scene_starts.end(), is_cut)) {
            ++last;
        }
        found.push_back({first, last});
        first = last + 1;
    }
    return found;
}

std::vector<EventRows> find_events(VectorIn frames, VectorIn values, const PhaseOptions& options) {
    std::vector<EventRows> events;
    for (const Stretch& stretch : stretches(frames, options.scene_starts)) {
        find_in(values, stretch.first, stretch.last, options, events);
    }
    return events;
}

}  // namespace mimetic
