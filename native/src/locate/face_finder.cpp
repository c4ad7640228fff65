// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/locate/face_spaces.hpp>
#include <mimetic/shared/error.hpp>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "locate/face_parts.hpp"

namespace mimetic {
namespace {

using locate::BatchSpace;
using locate::Level;
using locate::Pyramid;
using locate::Windows;

constexpr std::size_t kPassed = 800;  // windows whose likelihood is computed
constexpr std::size_t kSeeds = 24;    // places that are looked at closely
constexpr std::size_t kHints = 8;
constexpr double kApart = 0.35;          // windows: nearer places are one
constexpr double kCheekToCheek = 0.8;    // windows: two heads are further apart
constexpr double kRollStep = 0.17;       // radians
constexpr double kHalfStep = 1.0905077;  // 2^(1/8): between the search's sizes
constexpr int kHintReach = 3;            // pixels of the window

/// A place that may be a face's.
struct Seed {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    double width = 0;
    double score = 0;
    double votes = 0;
    int reach = 1;  ///< pixels of the window
};

struct Passed {
    std::size_t level = 0;
    int x = 0;
    int y = 0;
    float score = 0;
};

bool is_same(const Eigen::Vector2d& a, double a_width, const Eigen::Vector2d& b, double b_width,
             double apart) {
    return (a - b).norm() < apart * std::max(a_width, b_width) && a_width < 1.6 * b_width &&
           b_width < 1.6 * a_width;
}

Eigen::Vector2d center_of(const Level& level, const Passed& passed, int side) {
    const Eigen::Array2d middle(passed.x + 0.5 * side, passed.y + 0.5 * side);
    return middle * level.px - 0.5;
}

void copy_window(const cv::Mat1f& flat, int x, int y, int side, float* to) {
    for (int line = 0; line < side; ++line) to = std::copy_n(flat[y + line] + x, side, to);
}

}  // namespace

struct FaceFinder::Batch {
    explicit Batch(const FaceSpaces& of) : spaces(of), other(of.other), parts(of) {
        side = spaces.views[0].space.width;
        for (const auto& view : spaces.views) {
            views.emplace_back(view.space);
            cv::Mat1f filter(side, side);
            for (int i = 0; i < side * side; ++i)
                filter(i / side, i % side) = static_cast<float>(view.filter(i));
            filters.push_back(filter);
        }
    }

    cv::Mat1f highest_response(const cv::Mat1f& flat) const;
    std::vector<Passed> passed(const std::vector<Level>& levels) const;
    std::vector<Seed> seeds(const Pyramid& pyramid, const FaceSearch& options, double largest) const;
    FoundFace closely(const Pyramid& pyramid, const Seed& seed) const;
    std::vector<FoundFace> search(const Pyramid& pyramid, const FaceSearch& options, double largest,
                                  const std::vector<FaceHint>& hints) const;

    const FaceSpaces& spaces;
    BatchSpace other;
    locate::FaceParts parts;
    std::vector<BatchSpace> views;
    std::vector<cv::Mat1f> filters;
    int side = 0;
};

/// Of every window, by its upper left corner: how far the best filter is above its threshold.
cv::Mat1f FaceFinder::Batch::highest_response(const cv::Mat1f& flat) const {
    // One transform of the level serves all filters; what wraps round lies beyond the last window
    const cv::Size padded(cv::getOptimalDFTSize(flat.cols), cv::getOptimalDFTSize(flat.rows));
    const cv::Rect valid(0, 0, flat.cols - side + 1, flat.rows - side + 1);
    const auto spectrum_of = [&](const cv::Mat1f& values) {
        cv::Mat1f spectrum(padded, 0.0f);
        values.copyTo(spectrum({{0, 0}, values.size()}));
        cv::dft(spectrum, spectrum, 0, values.rows);
        return spectrum;
    };
    const cv::Mat1f of_level = spectrum_of(flat);
    cv::Mat1f best, product;
    for (std::size_t v = 0; v < filters.size(); ++v) {
        cv::mulSpectrums(of_level, spectrum_of(filters[v]), product, 0, true);
        cv::dft(product, product, cv::DFT_INVERSE | cv::DFT_SCALE, valid.height);
        const cv::Mat1f response = product(valid) - spaces.views[v].threshold;
        best = v == 0 ? response : cv::Mat1f(cv::max(best, response));
    }
    return best;
}

/// Local maxima of the filters above their thresholds, the highest first.
std::vector<Passed> FaceFinder::Batch::passed(const std::vector<Level>& levels) const {
    std::vector<std::vector<Passed>> by_level(levels.size());
    cv::parallel_for_({0, static_cast<int>(levels.size())}, [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const cv::Mat1f best = highest_response(levels[at].flat);
            cv::Mat1f highest;
            cv::dilate(best, highest, {});
            for (int y = 0; y < best.rows; ++y) {
                for (int x = 0; x < best.cols; ++x) {
                    if (best(y, x) > 0 && best(y, x) >= highest(y, x))
                        by_level[at].push_back({at, x, y, best(y, x)});
                }
            }
        }
    });
    std::vector<Passed> all;
    for (const auto& level : by_level) all.insert(all.end(), level.begin(), level.end());
    std::sort(all.begin(), all.end(), [](const Passed& a, const Passed& b) { return a.score > b.score; });
    if (all.size() > kPassed) all.resize(kPassed);
    return all;
}

std::vector<Seed> FaceFinder::Batch::seeds(const Pyramid& pyramid, const FaceSearch& options,
                                           double largest) const {
    const std::vector<Level> levels =
        locate::levels(pyramid, side, options.smallest, largest, options.steps_per_octave);
    const std::vector<Passed> all = passed(levels);
    if (all.empty()) return {};
    Windows windows(static_cast<Eigen::Index>(all.size()), side * side);
    for (std::size_t i = 0; i < all.size(); ++i) {
        copy_window(levels[all[i].level].flat, all[i].x, all[i].y, side,
                    windows.row(static_cast<Eigen::Index>(i)).data());
    }
    locate::normalize_rows(windows);
    Eigen::ArrayXf likelihood = views[0].of(windows).log_likelihood;
    for (std::size_t v = 1; v < views.size(); ++v)
        likelihood = likelihood.max(views[v].of(windows).log_likelihood);
    likelihood -= other.of(windows).log_likelihood;
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return likelihood(static_cast<Eigen::Index>(a)) > likelihood(static_cast<Eigen::Index>(b));
    });
    std::vector<Seed> kept;
    for (const std::size_t i : order) {
        const Level& level = levels[all[i].level];
        const Seed seed{center_of(level, all[i], side), level.width, likelihood(static_cast<Eigen::Index>(i)),
                        0, 1};
        const auto is_near = [&](const Seed& other_seed) {
            return is_same(seed.center, seed.width, other_seed.center, other_seed.width, kApart);
        };
        if (std::none_of(kept.begin(), kept.end(), is_near)) kept.push_back(seed);
        if (kept.size() == kSeeds) break;
    }
    return kept;
}

/// The likeliest place, size, turn and view near a seed, with the parts there.
FoundFace FaceFinder::Batch::closely(const Pyramid& pyramid, const Seed& seed) const {
    FoundFace best;
    double highest = -std::numeric_limits<double>::infinity();
    const int shifts = 2 * seed.reach + 1;
    Windows windows(shifts * shifts, side * side), normalized;
    Eigen::VectorXd evidence = Eigen::VectorXd::Zero(spaces.evidence_size());
    int best_view = 0;
    for (const double size : {1 / kHalfStep, 1.0, kHalfStep}) {
        for (const double roll : {-kRollStep, 0.0, kRollStep}) {
            const double px = seed.width * size / side;
            const cv::Size whole(side + 2 * seed.reach, side + 2 * seed.reach);
            const cv::Mat1f flat = pyramid.window(seed.center, px, roll, whole, 0.5 * side);
            for (int k = 0; k < shifts * shifts; ++k)
                copy_window(flat, k % shifts, k / shifts, side, windows.row(k).data());
            normalized = windows;
            locate::normalize_rows(normalized);
            const auto as_other = other.of(normalized);
            for (std::size_t v = 0; v < views.size(); ++v) {
                const auto as_face = views[v].of(normalized);
                const Eigen::ArrayXf ratio = as_face.log_likelihood - as_other.log_likelihood;
                Eigen::Index k = 0;
                if (!(ratio.maxCoeff(&k) > highest)) continue;
                highest = ratio(k);
                best_view = static_cast<int>(v);
                const Eigen::Vector2d shift(static_cast<double>(k % shifts - seed.reach),
                                            static_cast<double>(k / shifts - seed.reach));
                best.center = seed.center + px * (Eigen::Rotation2Dd(roll) * shift);
                best.width = seed.width * size;
                best.roll = roll;
                const ViewSpace& view = spaces.views[v];
                evidence.head<5>() << windows.row(k).cast<double>().dot(view.filter) - view.threshold,
                    ratio(k), as_face.within(k), as_face.from(k), as_other.within(k);
            }
        }
    }
    const ViewSpace& view = spaces.views[static_cast<std::size_t>(best_view)];
    best.yaw = view.yaw;
    const locate::PartPlaces found = parts.place(pyramid, best.center, best.width, best.roll, view);
    evidence(5) = found.prior;
    evidence(6) = std::log1p(seed.votes);
    evidence.tail(found.log_ratio.size()) = found.log_ratio;
    best.places = Points2(found.places.rows(), 2);
    for (Eigen::Index i = 0; i < found.places.rows(); ++i) {
        best.places.row(i) =
            best.center + best.width * (Eigen::Rotation2Dd(best.roll) * found.places.row(i).transpose());
    }
    best.evidence = evidence;
    const double odds = spaces.weights.head(evidence.size()).dot(evidence) + spaces.weights(evidence.size());
    best.probability = 1 / (1 + std::exp(-odds));
    return best;
}

std::vector<FoundFace> FaceFinder::Batch::search(const Pyramid& pyramid, const FaceSearch& options,
                                                 double largest, const std::vector<FaceHint>& hints) const {
    std::vector<Seed> all = seeds(pyramid, options, largest);
    for (auto& seed : all) {
        for (const auto& hint : hints) {
            if (is_same(seed.center, seed.width, hint.center, hint.width, kApart))
                seed.votes = std::max(seed.votes, hint.votes);
        }
    }
    for (std::size_t i = 0; i < std::min(hints.size(), kHints); ++i)
        all.push_back({hints[i].center, hints[i].width, 0, hints[i].votes, kHintReach});
    std::vector<FoundFace> found(all.size());
    cv::parallel_for_({0, static_cast<int>(all.size())}, [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i)
            found[static_cast<std::size_t>(i)] = closely(pyramid, all[static_cast<std::size_t>(i)]);
    });
    std::sort(found.begin(), found.end(),
              [](const FoundFace& a, const FoundFace& b) { return a.probability > b.probability; });
    std::vector<FoundFace> kept;
    for (auto& face : found) {
        const auto overlaps = [&](const FoundFace& other_face) {
            return (face.center - other_face.center).norm() <
                   kCheekToCheek * std::max(face.width, other_face.width);
        };
        if (face.probability >= options.least_probability && std::none_of(kept.begin(), kept.end(), overlaps))
            kept.push_back(std::move(face));
    }
    return kept;
}

FaceFinder::FaceFinder(FaceSpaces spaces) : spaces_(std::make_unique<const FaceSpaces>(std::move(spaces))) {
    spaces_->check();
    batch_ = std::make_unique<Batch>(*spaces_);
}

FaceFinder::~FaceFinder() = default;
FaceFinder::FaceFinder(FaceFinder&&) noexcept = default;
FaceFinder& FaceFinder::operator=(FaceFinder&&) noexcept = default;

const FaceSpaces& FaceFinder::spaces() const { return *spaces_; }

namespace {

/// A part of the image, turned and scaled, and the way back.
struct Turned {
    cv::Mat1f gray;
    cv::Matx23d image_from_turned = cv::Matx23d(1, 0, 0, 0, 1, 0);
    double roll = 0;
    double scale = 1;  ///< pixels of the image in one of the turned

    Eigen::Vector2d back(const Eigen::Vector2d& p) const {
        const auto& m = image_from_turned;
        return {m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2), m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2)};
    }
};

Turned turned(const Pyramid& pyramid, const Eigen::Vector2d& center, double scale, double roll,
              cv::Size size) {
    Turned made;
    made.roll = roll;
    made.scale = scale;
    const double c = scale * std::cos(roll), s = scale * std::sin(roll);
    const double mid_x = 0.5 * (size.width - 1), mid_y = 0.5 * (size.height - 1);
    made.image_from_turned =
        cv::Matx23d(c, -s, center.x() - c * mid_x + s * mid_y, s, c, center.y() - s * mid_x - c * mid_y);
    made.gray = pyramid.cut(center, scale, roll, size);
    return made;
}

std::vector<FoundFace> in_image(std::vector<FoundFace> found, const Turned& seen) {
    for (auto& face : found) {
        face.center = seen.back(face.center);
        face.width *= seen.scale;
        face.roll += seen.roll;
        for (Eigen::Index i = 0; i < face.places.rows(); ++i)
            face.places.row(i) = seen.back(face.places.row(i).transpose());
    }
    return found;
}

}  // namespace

std::vector<FoundFace> FaceFinder::find(GrayView image, const FaceSearch& options,
                                        const std::vector<FaceHint>& hints) const {
    check_image_size(image.rows, image.cols, "image");
    options.check();
    const cv::Mat1f gray = locate::float_image(image);
    const double largest = options.largest * std::min(image.rows, image.cols);
    const Pyramid pyramid(gray);
    if (options.roll == 0) return batch_->search(pyramid, options, largest, hints);
    const Eigen::Vector2d middle(0.5 * (image.cols - 1), 0.5 * (image.rows - 1));
    const Turned seen = turned(pyramid, middle, 1, options.roll, gray.size());
    std::vector<FaceHint> in_turned = hints;
    for (auto& hint : in_turned)
        hint.center = middle + Eigen::Rotation2Dd(-options.roll) * (hint.center - middle);
    return in_image(batch_->search(Pyramid(seen.gray), options, largest, in_turned), seen);
}

std::vector<FoundFace> FaceFinder::find_near(GrayView image, const FoundFace& before,
                                             double least_probability) const {
    check_image_size(image.rows, image.cols, "image");
    if (!(before.center.allFinite() && before.width >= 8 && before.width <= 16384 &&
          std::isfinite(before.roll)))
        throw InvalidInput("search near a face: its place must be finite and its width 8 to 16384 pixels");
    constexpr double kWidth = 48;  // pixels of the crop: twice the search's windows
    const auto size = static_cast<int>(std::lround(1.9 * kWidth));
    const Pyramid pyramid(locate::float_image(image));
    const Turned seen = turned(pyramid, before.center, before.width / kWidth, before.roll, {size, size});
    FaceSearch options;
    options.smallest = kWidth / 1.2;
    options.least_probability = least_probability;
    return in_image(batch_->search(Pyramid(seen.gray), options, 1.2 * kWidth, {}), seen);
}

}  // namespace mimetic
