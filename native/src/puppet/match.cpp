// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mimetic/puppet/match.hpp>
#include <mimetic/shared/checks.hpp>
#include <numbers>
#include <string>

#include "template_variants.hpp"

namespace mimetic {

namespace puppet {

namespace {

constexpr int kRefined = 3;   // variants that are matched at full size, of those that fit best at half of it
constexpr int kRefineBy = 2;  // pixels about where they fit best

/// Where a kernel fits, in its level's pixels.
struct Peak {
    float score = -std::numeric_limits<float>::infinity();
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    std::size_t variant = 0;
};

Eigen::Vector2d at_level(const Eigen::Vector2d& place, int level) {
    return ((place.array() + .5) * std::ldexp(1., -level) - .5).matrix();
}

Eigen::Vector2d from_level(const Eigen::Vector2d& place, int level) {
    return ((place.array() + .5) * std::ldexp(1., level) - .5).matrix();
}

/// Positions of a kernel's top-left pixel with its centre at most `radius` off, inside of the level.
Window positions(const ImageLevel& level, const Kernel& kernel, const Eigen::Vector2d& centre,
                 double radius) {
    const double x = centre.x() - .5 * (kernel.cols - 1), y = centre.y() - .5 * (kernel.rows - 1);
    const int last_x = level.cols() - kernel.cols + 1, last_y = level.rows() - kernel.rows + 1;
    const auto low = [radius](double at, int last) {
        return static_cast<int>(std::clamp(std::round(at - radius), 0., std::max(0., last - 1.)));
    };
    const auto high = [radius](double at, int last) {
        return static_cast<int>(
            std::clamp(std::round(at + radius) + 1, std::min(1., double(last)), double(last)));
    };
    return {low(x, last_x), low(y, last_y), high(x, last_x), high(y, last_y)};
}

Window everywhere(const ImageLevel& level, const Kernel& kernel) {
    return {0, 0, level.cols() - kernel.cols + 1, level.rows() - kernel.rows + 1};
}

/// How far the peak of a parabola through three scores is from the middle one, and how much higher.
std::pair<double, double> parabola(double before, double middle, double after) {
    const double bend = before - 2 * middle + after;
    if (!(bend < -1e-9)) {
        return {0, 0};
    }
    const double at = std::clamp(.5 * (before - after) / bend, -.5, .5);
    return {at, .5 * at * (after - before) + .5 * at * at * bend};
}

Peak peak_of(const Eigen::MatrixXf& scores, const Window& window, const Kernel& kernel) {
    Eigen::Index y = 0, x = 0;
    const float highest = scores.maxCoeff(&y, &x);
    const bool has_sides_x = x > 0 && x + 1 < scores.cols(), has_sides_y = y > 0 && y + 1 < scores.rows();
    const auto [off_x, gain_x] =
        has_sides_x ? parabola(scores(y, x - 1), highest, scores(y, x + 1)) : std::pair{0., 0.};
    const auto [off_y, gain_y] =
        has_sides_y ? parabola(scores(y - 1, x), highest, scores(y + 1, x)) : std::pair{0., 0.};
    Peak peak;
    peak.score = static_cast<float>(std::min(1., highest + gain_x + gain_y));
    peak.centre = {window.x0 + static_cast<double>(x) + off_x + .5 * (kernel.cols - 1),
                   window.y0 + static_cast<double>(y) + off_y + .5 * (kernel.rows - 1)};
    return peak;
}

}  // namespace

/// Sizes of one image, each half of the one before.
class Levels {
public:
    void load(const GrayView& image) {
        levels_.resize(std::max(levels_.size(), std::size_t{1}));
        areas_.assign(levels_.size(), {});
        levels_.front().load(image);
        num_loaded_ = 1;
    }

    /// Makes sure that there are so many.
    void halve_to(int num_levels) {
        const auto number = static_cast<std::size_t>(num_levels);
        levels_.resize(std::max(levels_.size(), number));
        areas_.resize(levels_.size());
        for (; num_loaded_ < number; ++num_loaded_) {
            levels_[num_loaded_].load_half(levels_[num_loaded_ - 1]);
        }
    }

    const ImageLevel& operator[](int level) const { return levels_[static_cast<std::size_t>(level)]; }

    /// Windows of the kernel at these positions will be looked at.
    void want(int level, const Window& window, const Kernel& kernel) {
        if (!window.is_empty()) {
            Window& area = areas_[static_cast<std::size_t>(level)];
            area =
                area.united({window.x0, window.y0, window.x1 + kernel.cols - 1, window.y1 + kernel.rows - 1});
        }
    }

    void sum() {
        for (std::size_t i = 0; i < num_loaded_; ++i) {
            if (!areas_[i].is_empty()) {
                levels_[i].sum(areas_[i]);
            }
        }
    }

private:
    std::vector<ImageLevel> levels_;
    std::vector<Window> areas_;
    std::size_t num_loaded_ = 0;
};

namespace {

/// A template's way through the levels: to search with at half its size, then to match.
class Search {
public:
    Search(Levels& levels, const PreparedTemplate& look, const Eigen::Vector2d& centre, double radius,
           bool is_everywhere)
        : levels_(levels), look_(look), centre_(centre), radius_(radius), is_everywhere_(is_everywhere) {}

    void announce() const {
        for (const Variant& variant : look_.variants) {
            levels_.want(look_.level, fine_window(variant, kRefineBy + 1), variant.fine);
            if (is_coarse_first()) {
                levels_.want(look_.level + 1, coarse_window(variant), variant.coarse);
            }
        }
    }

    Peak run() const {
        std::vector<Peak> starts;
        for (std::size_t i = 0; i < look_.variants.size(); ++i) {
            const Variant& variant = look_.variants[i];
            Peak start;
            start.variant = i;
            if (is_coarse_first()) {
                const Window window = coarse_window(variant);
                if (window.is_empty()) {
                    continue;
                }
                start = peak_of(correlate(levels_[look_.level + 1], variant.coarse, window), window,
                                variant.coarse);
                start.centre = from_level(start.centre, 1);
                start.variant = i;
            }
            starts.push_back(start);
        }
        std::stable_sort(starts.begin(), starts.end(),
                         [](const Peak& a, const Peak& b) { return a.score > b.score; });
        starts.resize(std::min(starts.size(), std::size_t{kRefined}));
        Peak best;
        for (const Peak& start : starts) {
            const Variant& variant = look_.variants[start.variant];
            // Sums are there for the windows that were announced, and for no others
            const Window window = is_coarse_first()
                                      ? positions(levels_[look_.level], variant.fine, start.centre, kRefineBy)
                                            .intersected(fine_window(variant, kRefineBy + 1))
                                      : fine_window(variant, 0);
            if (window.is_empty()) {
                continue;
            }
            Peak peak = peak_of(correlate(levels_[look_.level], variant.fine, window), window, variant.fine);
            peak.variant = start.variant;
            if (peak.score > best.score) {
                best = peak;
            }
        }
        return best;
    }

private:
    bool is_coarse_first() const { return is_everywhere_ || look_.variants.size() > 1; }

    Window fine_window(const Variant& variant, int margin) const {
        const ImageLevel& level = levels_[look_.level];
        return is_everywhere_ ? everywhere(level, variant.fine)
                              : positions(level, variant.fine, at_level(centre_, look_.level),
                                          margin + std::ldexp(radius_, -look_.level));
    }

    Window coarse_window(const Variant& variant) const {
        const ImageLevel& level = levels_[look_.level + 1];
        return is_everywhere_ ? everywhere(level, variant.coarse)
                              : positions(level, variant.coarse, at_level(centre_, look_.level + 1),
                                          std::ldexp(radius_, -look_.level - 1));
    }

    Levels& levels_;
    const PreparedTemplate& look_;
    Eigen::Vector2d centre_;
    double radius_;
    bool is_everywhere_;
};

TemplateMatch match_of(const Peak& peak, const PreparedTemplate& look) {
    if (!std::isfinite(peak.score)) {  // no window of the template's size is in the image
        return {-1, look.place, 1, 0, false};
    }
    const Variant& variant = look.variants[peak.variant];
    return {peak.score, from_level(peak.centre, look.level) + look.trim, variant.scale, variant.rotation,
            false};
}

void check(const LookTemplate& look, std::size_t number) {
    const std::string name = "template " + std::to_string(number);
    const GrayPicture& picture = look.picture;
    check_range(name + " height", picture.rows, 8, 512);
    check_range(name + " width", picture.cols, 8, 512);
    require(picture.pixels.size() == static_cast<std::size_t>(picture.rows * picture.cols),
            name + " has another number of pixels than its sides say");
    require(look.place.allFinite() && look.place.cwiseAbs().maxCoeff() < 1e6, name + " has no finite place");
    check_range(name + " group", look.group, 0, 1000);
}

}  // namespace

}  // namespace puppet

struct TemplateMatcher::State {
    MatchOptions options;
    std::vector<puppet::PreparedTemplate> looks;
    std::map<int, Eigen::Vector2d> offsets;  // of a group that is seen, from its templates' places
    int anchor = 0;      // the group of the largest templates, which a lost face is searched with
    int num_levels = 1;  // with the one that is searched
    puppet::Levels levels;

    Eigen::Vector2d offset_of(int group) const {
        const auto at = offsets.find(group);
        if (at != offsets.end()) {
            return at->second;
        }
        return offsets.empty() ? Eigen::Vector2d::Zero() : offsets.begin()->second;
    }

    std::vector<TemplateMatch> search(const std::vector<std::size_t>& chosen, bool is_everywhere) {
        const bool is_coarse_first = is_everywhere || looks.front().variants.size() > 1;
        levels.halve_to(is_coarse_first ? num_levels : num_levels - 1);
        std::vector<puppet::Search> searches;
        for (const std::size_t i : chosen) {
            const auto& look = looks[i];
            searches.emplace_back(levels, look, look.place - look.trim + offset_of(look.group),
                                  options.search_radius, is_everywhere);
            searches.back().announce();
        }
        levels.sum();
        std::vector<TemplateMatch> matches;
        matches.reserve(chosen.size());
        for (std::size_t k = 0; k < chosen.size(); ++k) {
            matches.push_back(puppet::match_of(searches[k].run(), looks[chosen[k]]));
        }
        return matches;
    }

    std::vector<std::size_t> all() const {
        std::vector<std::size_t> indices(looks.size());
        for (std::size_t i = 0; i < indices.size(); ++i) {
            indices[i] = i;
        }
        return indices;
    }

    std::vector<std::size_t> anchors() const {
        std::vector<std::size_t> indices = all();
        std::erase_if(indices, [this](std::size_t i) { return looks[i].group != anchor; });
        return indices;
    }

    /// Each group goes where its best template is.
    void take_places(const std::vector<std::size_t>& chosen, const std::vector<TemplateMatch>& matches) {
        std::map<int, double> best;
        offsets.clear();
        for (std::size_t k = 0; k < chosen.size(); ++k) {
            const auto& look = looks[chosen[k]];
            const TemplateMatch& match = matches[k];
            const auto at = best.find(look.group);
            if (match.score >= options.least_score && (at == best.end() || match.score > at->second)) {
                best[look.group] = match.score;
                offsets[look.group] = match.place - look.place;
            }
        }
    }
};

void MatchOptions::check() const {
    check_range("search_radius", search_radius, 1, 64);
    check_range("most_pixels", most_pixels, 64, 16384);
    check_range("least_score", least_score, -1, 1);
    require(!scales.empty() && !rotations.empty() && scales.size() * rotations.size() <= 100,
            "scales and rotations must have 1 to 100 combinations");
    for (const double scale : scales) {
        check_range("scales", scale, .5, 2);
    }
    for (const double rotation : rotations) {
        check_range("rotations", rotation, -.5 * std::numbers::pi, .5 * std::numbers::pi);
    }
}

MatrixRows correlation_map(const GrayView& image, const GrayView& picture) {
    require(
        picture.rows >= 1 && picture.cols >= 1 && picture.rows <= image.rows && picture.cols <= image.cols,
        "the template is larger than the image");
    require(picture.rows * picture.cols <= 16384, "the template has more than 16384 pixels");
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < picture.rows; ++y) {
        pixels.insert(pixels.end(), picture.row(y), picture.row(y) + picture.cols);
    }
    const puppet::Kernel kernel(pixels.data(), picture.rows, picture.cols);
    puppet::ImageLevel level;
    level.load(image);
    level.sum({0, 0, image.cols, image.rows});
    return puppet::correlate(level, kernel, puppet::everywhere(level, kernel)).cast<double>();
}

TemplateMatcher::TemplateMatcher(const std::vector<LookTemplate>& templates, const MatchOptions& options)
    : state_(std::make_unique<State>()) {
    options.check();
    require(!templates.empty() && templates.size() <= 1000, "1 to 1000 templates can be matched");
    state_->options = options;
    int most = 0;
    for (std::size_t i = 0; i < templates.size(); ++i) {
        puppet::check(templates[i], i);
        state_->looks.push_back(puppet::prepare(templates[i], options));
        state_->num_levels = std::max(state_->num_levels, state_->looks.back().level + 2);
        const int size = templates[i].picture.rows * templates[i].picture.cols;
        if (size > most) {
            most = size;
            state_->anchor = templates[i].group;
        }
    }
}

TemplateMatcher::~TemplateMatcher() = default;
TemplateMatcher::TemplateMatcher(TemplateMatcher&&) noexcept = default;
TemplateMatcher& TemplateMatcher::operator=(TemplateMatcher&&) noexcept = default;

std::vector<TemplateMatch> TemplateMatcher::match(const GrayView& image) {
    require(std::min(image.rows, image.cols) >> (state_->num_levels - 1) >= 1,
            "the image is too small for the templates");
    State& state = *state_;
    state.levels.load(image);
    const auto all = state.all();
    auto matches = state.search(all, false);
    if (!state.options.follow) {
        return matches;
    }
    state.take_places(all, matches);
    if (state.offsets.empty()) {
        const auto anchors = state.anchors();
        state.take_places(anchors, state.search(anchors, true));
        if (!state.offsets.empty()) {
            matches = state.search(all, false);
            for (TemplateMatch& match : matches) {
                match.found_again = true;
            }
            state.take_places(all, matches);
        }
    }
    return matches;
}

}  // namespace mimetic
