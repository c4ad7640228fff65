// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <filesystem>
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/well_lit.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <utility>

#include "locate/eyes.hpp"
#include "locate/measure.hpp"
#include "locate/widened.hpp"
#include "shared/gray.hpp"

namespace mimetic {
namespace {

using locate::Expected;
using locate::FacePatch;
using locate::Features;
using locate::measure_in_patch;

constexpr double kDetectorSide = 480;   // the longer side of the image that the face cascade sees
constexpr double kCropSide = 160;       // pixels of a face box when eyes are sought
constexpr int kNeighbours = 3;          // windows that have to agree where the cascade decides alone
constexpr double kWindowPerBox = 0.85;  // the eigenspaces' window, two pupil distances, in widths of a box
constexpr double kMiddleInBox = 0.61;   // of the box: half way from the eyes to the mouth
constexpr double kSearchNearModules = 0.12;  // pupil distances
constexpr double kPlain = 0.75;              // likelihood of a cascade's face, never wrong in tests
constexpr double kEyesAgree = 0.2;           // pupil distances
constexpr double kSure = 0.8;                // likelihood above which no other lean is tried
constexpr double kLean = 0.436;              // radians: what upright searches miss
constexpr double kFilling = 0.4;             // of a widened picture's shorter side: a face that fills it

std::unique_ptr<cv::CascadeClassifier> load(const std::string& directory, const char* name) {
    const std::string path = directory + "/haarcascade_" + name + ".xml";
    auto cascade = std::make_unique<cv::CascadeClassifier>();
    bool loaded = false;
    try {
        loaded = std::filesystem::is_regular_file(path) && cascade->load(path);
    } catch (const cv::Exception&) {  // not XML
    }
    if (!loaded) {
        throw InvalidInput("the face detector's file cannot be read: " + path +
                           "; install Debian's opencv-data and build again");
    }
    return cascade;
}

/// The image turned about its centre: faces leant further than about 20 degrees are missed upright.
struct Upright {
    Upright(const cv::Mat& image, double lean) : gray(image), roll(lean) {
        if (lean == 0) return;
        const cv::Point2f center(0.5f * static_cast<float>(image.cols - 1),
                                 0.5f * static_cast<float>(image.rows - 1));
        const cv::Matx23d turn(cv::getRotationMatrix2D(center, lean * 180 / std::numbers::pi, 1));
        cv::invertAffineTransform(turn, image_from_gray);
        cv::Mat turned;
        cv::warpAffine(image, turned, turn, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        gray = std::move(turned);
    }

    Eigen::Vector2d in_image(const Eigen::Vector2d& p) const {
        const auto& m = image_from_gray;
        return {m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2), m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2)};
    }

    cv::Mat gray;
    double roll;  ///< radians, clockwise: of faces that stand upright here
    cv::Matx23d image_from_gray = cv::Matx23d(1, 0, 0, 0, 1, 0);
};

struct Candidate {
    cv::Rect2d box;  ///< in the (turned) image
    double votes = 0;
};

/// The average face, its nose and mouth where the modules found them.
Expected expected_of(const FacePatch& patch, const Eigen::Vector2d& nose, const Eigen::Vector2d& mouth) {
    Expected expected = locate::average_face();
    expected.search = kSearchNearModules;
    const auto middle = [&](const std::string& name) {
        return Eigen::Vector2d(0.5 * (expected.at(name + ".L") + expected.at(name + ".R")));
    };
    const Eigen::Vector2d of_nose = patch.to_ipd(nose) - middle("ala");
    const Eigen::Vector2d of_mouth = patch.to_ipd(mouth) - middle("mouth_corner");
    for (auto& [name, place] : expected.features) {
        if (name.starts_with("nostril") || name.starts_with("ala")) place += of_nose;
        if (name.starts_with("mouth") || name.starts_with("lip")) place += of_mouth;
    }
    expected.curves.at("jaw").rowwise() += of_mouth.transpose();
    return expected;
}

/// A face of the eigenspaces, measured.
FaceFeatures measured(ColorView image, const FaceSpaces& spaces, const FoundFace& found) {
    const auto place = [&](const char* name) {
        return Eigen::Vector2d(found.places.row(spaces.module(name)));
    };
    const FacePatch first = locate::make_patch(image, place("pupil.R"), place("pupil.L"));
    Expected eyes = locate::average_face();
    eyes.search = kSearchNearModules;
    Features irises;
    locate::measure_irises(first, eyes, irises);
    const FacePatch patch = locate::make_patch(image, first.to_image(irises.at("pupil.R").position),
                                               first.to_image(irises.at("pupil.L").position));
    FaceFeatures face = measure_in_patch(patch, expected_of(patch, place("nose"), place("mouth")));
    const double width = found.width / kWindowPerBox;
    face.box << found.center.x() - width / 2, found.center.y() - kMiddleInBox * width, width, width;
    face.likelihood = found.probability;
    face.yaw = found.yaw;
    face.roll = found.roll;
    return face;
}

bool is_same(const FaceFeatures& a, const FaceFeatures& b) {
    const Eigen::Vector2d apart = (a.box - b.box).head<2>() + 0.5 * (a.box - b.box).tail<2>();
    return apart.norm() < 0.5 * std::max(a.box(2), b.box(2));
}

bool eyes_agree(const FaceFeatures& a, const FaceFeatures& b) {
    const auto at = [](const FaceFeatures& face, const char* name) { return face.find(name)->position; };
    const double ipd = (at(b, "pupil.L") - at(b, "pupil.R")).norm();
    return (at(a, "pupil.L") - at(b, "pupil.L")).norm() < kEyesAgree * ipd &&
           (at(a, "pupil.R") - at(b, "pupil.R")).norm() < kEyesAgree * ipd;
}

/// The eigenspaces' faces, corrected and completed by the cascades' sure detections: on photographs of
/// laughter, which no training picture shows, the cascades err less.
std::vector<FaceFeatures> together(std::vector<FaceFeatures> by_spaces,
                                   const std::vector<FaceFeatures>& by_cascades) {
    if (by_spaces.empty()) return by_cascades;
    for (const auto& face : by_cascades) {
        if (face.likelihood < kPlain) continue;
        const auto same = std::find_if(by_spaces.begin(), by_spaces.end(),
                                       [&](const FaceFeatures& other) { return is_same(face, other); });
        if (same == by_spaces.end())
            by_spaces.push_back(face);
        else if (!eyes_agree(*same, face))
            *same = face;
    }
    return by_spaces;
}

}  // namespace

void LocateOptions::check() const {
    if (!(smallest_face >= 0.02 && smallest_face <= 1)) {
        throw InvalidInput("smallest_face is " + std::to_string(smallest_face) +
                           "; it is a part of the image's shorter side, 0.02 to 1");
    }
    if (!(least_likelihood >= 0 && least_likelihood <= 1)) {
        throw InvalidInput("least_likelihood is " + std::to_string(least_likelihood) + "; it must be 0 to 1");
    }
}

struct FaceLocator::Cascades {
    std::unique_ptr<cv::CascadeClassifier> face;
    std::unique_ptr<cv::CascadeClassifier> eye;

    std::vector<Candidate> boxes(const cv::Mat& gray, double smallest, int neighbours);
    locate::EyePair eyes(const cv::Mat& gray, const cv::Rect2d& box);
    std::vector<FaceFeatures> locate(ColorView image, const Upright& seen, const LocateOptions& options,
                                     const std::vector<Candidate>& all);
    std::vector<FaceFeatures> locate(ColorView image, const cv::Mat& gray, const Upright& seen,
                                     const LocateOptions& options, const std::vector<Candidate>& all,
                                     const FaceFinder& finder);
};

/// OpenCV's classifiers keep what they work on: each search has some of its own, two of each, as two roll
/// angles are searched in parallel.
struct FaceLocator::CascadePairs {
    using Pair = std::array<Cascades, 2>;

    explicit CascadePairs(const std::string& from) : directory(from) { give_back(take()); }

    std::unique_ptr<Pair> take() {
        {
            const std::lock_guard lock(busy);
            if (!idle.empty()) {
                std::unique_ptr<Pair> pair = std::move(idle.back());
                idle.pop_back();
                return pair;
            }
        }
        auto pair = std::make_unique<Pair>();
        for (Cascades& cascades : *pair) {
            cascades.face = load(directory, "frontalface_alt2");
            cascades.eye = load(directory, "eye");
        }
        return pair;
    }

    void give_back(std::unique_ptr<Pair> pair) {
        const std::lock_guard lock(busy);
        idle.push_back(std::move(pair));
    }

    std::string directory;
    std::mutex busy;
    std::vector<std::unique_ptr<Pair>> idle;
};

std::vector<Candidate> FaceLocator::Cascades::boxes(const cv::Mat& gray, double smallest, int neighbours) {
    const double scale = std::min(1.0, kDetectorSide / std::max(gray.rows, gray.cols));
    cv::Mat small = gray;
    if (scale < 1) cv::resize(gray, small, {}, scale, scale, cv::INTER_AREA);
    const int least = std::max(20, static_cast<int>(smallest * std::min(small.rows, small.cols)));
    std::vector<cv::Rect> squares;
    std::vector<int> votes;
    face->detectMultiScale(small, squares, votes, 1.1, neighbours, 0, {least, least});
    std::vector<Candidate> found;
    for (std::size_t i = 0; i < squares.size(); ++i) {
        Candidate candidate;
        candidate.box = {squares[i].x / scale, squares[i].y / scale, squares[i].width / scale,
                         squares[i].height / scale};
        candidate.votes = votes[i];
        found.push_back(candidate);
    }
    return found;
}

locate::EyePair FaceLocator::Cascades::eyes(const cv::Mat& gray, const cv::Rect2d& box) {
    const double scale = kCropSide / box.width;
    const cv::Matx23d crop_from_image(scale, 0, -scale * box.x, 0, scale, -scale * box.y);
    cv::Mat source = gray;
    cv::Matx23d warp = crop_from_image;
    if (scale < 0.6) {
        cv::resize(gray, source, {}, scale, scale, cv::INTER_AREA);
        warp = cv::Matx23d(1, 0, -scale * box.x, 0, 1, -scale * box.y);
    }
    const int side = static_cast<int>(kCropSide);
    cv::Mat crop;
    cv::warpAffine(source, crop, warp, {side, side}, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    std::vector<cv::Rect> hits;
    const cv::Rect upper(0, side / 6, side, side * 45 / 100);
    eye->detectMultiScale(crop(upper), hits, 1.1, 2, 0, {side / 7, side / 7},
                          {side * 45 / 100, side * 45 / 100});
    std::vector<Eigen::Vector2d> centers;
    centers.reserve(hits.size());
    for (const auto& hit : hits) {
        centers.emplace_back(hit.x + 0.5 * hit.width, hit.y + 0.54 * hit.height + upper.y);
    }
    cv::Mat1f luminance;
    crop.convertTo(luminance, CV_32F, 1.0 / 255);
    auto pair = locate::find_eyes(luminance, centers);
    for (auto* iris : {&pair.right, &pair.left}) {
        iris->center = iris->center / scale + Eigen::Vector2d(box.x, box.y);
    }
    return pair;
}

FaceLocator::FaceLocator(const std::string& cascade_directory, const LocateOptions& options)
    : cascades_(std::make_unique<CascadePairs>(cascade_directory)), options_(options) {
    options_.check();
}

FaceLocator::FaceLocator(const std::string& cascade_directory, FaceSpaces spaces,
                         const LocateOptions& options)
    : FaceLocator(cascade_directory, options) {
    for (const char* name : {"pupil.L", "pupil.R", "nose", "mouth"}) spaces.module(name);
    finder_ = std::make_unique<FaceFinder>(std::move(spaces));
}

FaceLocator::~FaceLocator() = default;
FaceLocator::FaceLocator(FaceLocator&&) noexcept = default;
FaceLocator& FaceLocator::operator=(FaceLocator&&) noexcept = default;

std::vector<FaceFeatures> FaceLocator::locate(ColorView image) const {
    check_image_size(image.rows, image.cols, "image");
    std::vector<FaceFeatures> found = search(image, options_);
    if (found.empty()) found = search(with_raised_shadows(image).view(), options_);
    for (FaceFeatures& face : found) {
        const std::optional<ColorImage> lit = well_lit(image, crop_about(face));
        if (!lit) continue;
        const std::vector<FaceFeatures> again = search(lit->view(), options_);
        const auto same =
            std::ranges::find_if(again, [&](const auto& other) { return is_same(face, other); });
        if (same != again.end()) face = *same;
    }
    if (found.empty()) {
        const locate::Widened wide(image);
        LocateOptions filling = options_;
        filling.smallest_face = std::max(filling.smallest_face, kFilling);
        for (FaceFeatures& face : search(wide.view(), filling)) {
            found.push_back(wide.in_picture(std::move(face)));
        }
    }
    return found;
}

std::vector<FaceFeatures> FaceLocator::search(ColorView image, const LocateOptions& options) const {
    const cv::Mat gray = to_gray(image);
    const auto surest = [](const std::vector<FaceFeatures>& faces) {
        double likelihood = 0;
        for (const auto& face : faces) likelihood = std::max(likelihood, face.likelihood);
        return likelihood;
    };
    const auto is_sure = [&](const std::vector<FaceFeatures>& faces) {
        return !faces.empty() && surest(faces) >= (finder_ ? kSure : options.least_likelihood);
    };
    const auto leant_by = [&](double roll, Cascades& cascades) {
        const Upright seen(gray, roll);
        const std::vector<Candidate> boxes =
            cascades.boxes(seen.gray, options.smallest_face, finder_ ? 1 : kNeighbours);
        std::vector<FaceFeatures> here = cascades.locate(image, seen, options, boxes);
        if (finder_) here = together(cascades.locate(image, gray, seen, options, boxes, *finder_), here);
        return here;
    };
    std::unique_ptr<CascadePairs::Pair> pair = cascades_->take();
    std::vector<FaceFeatures> found = leant_by(0, pair->at(0));
    if (!is_sure(found)) {
        std::array<std::vector<FaceFeatures>, 2> leant;
        cv::parallel_for_({0, 2}, [&](const cv::Range& range) {
            for (int i = range.start; i < range.end; ++i) {
                const auto at = static_cast<std::size_t>(i);
                leant[at] = leant_by(i == 0 ? kLean : -kLean, pair->at(at));
            }
        });
        for (auto& here : leant) {
            // Part of a leant face can look somewhat like an upright one
            if (!is_sure(found) && surest(here) > surest(found)) found = std::move(here);
        }
    }
    cascades_->give_back(std::move(pair));
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.box(2) > b.box(2); });
    return found;
}

/// Faces of the eigenspaces, which also look where the cascade points.
std::vector<FaceFeatures> FaceLocator::Cascades::locate(ColorView image, const cv::Mat& gray,
                                                        const Upright& seen, const LocateOptions& options,
                                                        const std::vector<Candidate>& all,
                                                        const FaceFinder& finder) {
    const GrayView view{gray.data, gray.rows, gray.cols, static_cast<std::ptrdiff_t>(gray.step)};
    FaceSearch search;
    search.smallest =
        std::max(16.0, kWindowPerBox * options.smallest_face * std::min(image.rows, image.cols));
    search.least_probability = options.least_likelihood;
    search.roll = seen.roll;
    std::vector<FaceHint> hints;
    for (const auto& candidate : all) {
        const auto& box = candidate.box;
        hints.push_back({seen.in_image({box.x + 0.5 * box.width, box.y + kMiddleInBox * box.width}),
                         kWindowPerBox * box.width, candidate.votes});
    }
    std::vector<FaceFeatures> found;
    for (const auto& place : finder.find(view, search, hints))
        found.push_back(measured(image, finder.spaces(), place));
    return found;
}

/// Faces of the cascades alone.
std::vector<FaceFeatures> FaceLocator::Cascades::locate(ColorView image, const Upright& seen,
                                                        const LocateOptions& options,
                                                        const std::vector<Candidate>& all) {
    std::vector<FaceFeatures> found;
    for (const auto& candidate : all) {
        if (candidate.votes <= kNeighbours) continue;
        const locate::EyePair pair = eyes(seen.gray, candidate.box);
        const FacePatch patch =
            locate::make_patch(image, seen.in_image(pair.right.center), seen.in_image(pair.left.center));
        FaceFeatures made = measure_in_patch(patch, locate::average_face());
        const auto& box = candidate.box;
        const Eigen::Vector2d middle = seen.in_image({box.x + box.width / 2, box.y + box.height / 2});
        made.box << middle.x() - box.width / 2, middle.y() - box.height / 2, box.width, box.height;
        made.roll = seen.roll;
        const double mouth = made.find("lip_line")->likelihood;
        made.likelihood =
            (1 - std::exp(-candidate.votes / 8)) * std::sqrt(pair.likelihood) * (0.5 + 0.5 * mouth);
        if (made.likelihood >= options.least_likelihood) found.push_back(std::move(made));
    }
    return found;
}

}  // namespace mimetic
