// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <mimetic/locate/glasses.hpp>
#include <mimetic/shared/error.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

constexpr double kMm = 1e-3;
constexpr double kNearest = .05;  // metres that eyes are before a camera that sees them
// Where glasses sit: this far before the middle between the eyes' centres, and the less the further aside
constexpr double kBefore = 22, kAside = 62, kBack = 18;  // mm
constexpr double kFinest = 1.2;                          // pixels a mm that are looked at
// Half widths of lines that are looked for, mm, and the largest contrast that a place counts with
constexpr std::array<int, 2> kReach = {2, 4};
constexpr float kLeast = -.02F, kMost = .2F;
// Contrast of the faintest line, of the skin's brightness. Of 33 bare faces (frames of five clips and stills)
// the most was .05, of the same with frames drawn on them, 2 mm wide and dark, the median .1 to .2
constexpr float kRim = .06F;
constexpr float kDimmest = 20;  // grey levels that the skin counts as at least
// Below an eye, and over the nose, mm from the middle between the eyes
constexpr int kInner = 18, kOuter = 42, kHighest = -13, kLowest = -35;
constexpr int kNose = 7, kBridgeTop = 10, kBridgeBottom = -13;
// Around an eye, mm and degrees from straight aside, where a lens may end
constexpr int kSmallest = 12, kLargest = 36, kStep = 3, kFirst = -25, kLast = 205;

/// What a picture shows before a face where glasses would sit, by mm right and up from between the eyes as
/// the subject's left and up.
class Sheet {
public:
    Sheet(const ColorView& image, const Camera& camera, const Eigen::Isometry3d& camera_from_head,
          const Points& eyes)
        : camera_(camera), pose_(camera_from_head), middle_(eyes.colwise().mean()) {
        cv::cvtColor(as_matrix(image), gray_, cv::COLOR_RGB2GRAY);
        const double fineness = (pixel(1, 0) - pixel(-1, 0)).norm() / 2;
        if (fineness > kFinest) {
            scale_ = kFinest / fineness;
            cv::resize(gray_, gray_, {}, scale_, scale_, cv::INTER_AREA);
        }
    }

    Eigen::Vector3d place(double x, double y) const {
        const double before = kBefore - kBack * (x / kAside) * (x / kAside);
        return middle_ + kMm * Eigen::Vector3d(x, y, before);
    }

    /// Grey levels of places; outside of the picture those of its border.
    cv::Mat1f shown(int rows, int cols, const auto& place_of) const {
        cv::Mat2f map(rows, cols);
        const double shift = (scale_ - 1) / 2;
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < cols; ++x) {
                const Eigen::Vector2d mm = place_of(y, x);
                const Eigen::Vector2d at = pixel(mm.x(), mm.y());
                map(y, x) = {static_cast<float>(at.x() * scale_ + shift),
                             static_cast<float>(at.y() * scale_ + shift)};
            }
        }
        cv::Mat1b fetched;
        cv::remap(gray_, fetched, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        cv::Mat1f levels;
        fetched.convertTo(levels, CV_32F);
        return levels;
    }

private:
    Eigen::Vector2d pixel(double x, double y) const { return camera_.project(pose_ * place(x, y)); }

    Camera camera_;
    Eigen::Isometry3d pose_;
    Eigen::Vector3d middle_;
    cv::Mat1b gray_;
    double scale_ = 1;
};

/// How much darker (sign -1) or brighter (1) a place is than both sides of a line across the rows, of
/// `level`.
cv::Mat1f line_contrast(const cv::Mat1f& values, int sign, float level) {
    cv::Mat1f contrast(values.size(), kLeast);
    for (int y = 0; y < values.rows; ++y) {
        for (int x = 0; x < values.cols; ++x) {
            for (const int reach : kReach) {
                if (y >= reach && y + reach < values.rows) {
                    const float here = static_cast<float>(sign) * values(y, x);
                    const float beside = std::max(static_cast<float>(sign) * values(y - reach, x),
                                                  static_cast<float>(sign) * values(y + reach, x));
                    contrast(y, x) =
                        std::max(contrast(y, x), std::clamp((here - beside) / level, kLeast, kMost));
                }
            }
        }
    }
    return contrast;
}

struct Path {
    float mean = 0;         // of what it goes over
    std::vector<int> rows;  // of each column
};

/// The path from the first to the last column with the greatest mean, at most a row up or down a column.
Path best_path(const cv::Mat1f& values) {
    cv::Mat1f sums = values.clone();
    cv::Mat1i from(values.size(), 0);
    for (int x = 1; x < values.cols; ++x) {
        for (int y = 0; y < values.rows; ++y) {
            int best = y;
            for (const int other : {y - 1, y + 1}) {
                if (other >= 0 && other < values.rows && sums(other, x - 1) > sums(best, x - 1)) best = other;
            }
            from(y, x) = best;
            sums(y, x) += sums(best, x - 1);
        }
    }
    Path path;
    path.rows.resize(static_cast<std::size_t>(values.cols));
    cv::Point end;
    cv::minMaxLoc(sums.col(values.cols - 1), nullptr, nullptr, nullptr, &end);
    int row = end.y;
    path.mean = sums(row, values.cols - 1) / static_cast<float>(values.cols);
    for (int x = values.cols - 1; x >= 0; --x) {
        path.rows[static_cast<std::size_t>(x)] = row;
        row = from(row, x);
    }
    return path;
}

/// Of the columns from `left` to `right` (mm), the best line between `top` and `bottom`.
Path line_between(const Sheet& sheet, int left, int right, int top, int bottom, int sign, float level) {
    const int margin = kReach.back();
    const cv::Mat1f values = sheet.shown(top - bottom + 1 + 2 * margin, right - left + 1, [&](int y, int x) {
        return Eigen::Vector2d(left + x, top + margin - y);
    });
    const cv::Mat1f contrast = line_contrast(values, sign, level);
    return best_path(contrast.rowRange(margin, contrast.rows - margin));
}

/// The lower half of a lens's rim. side: 1 for the subject's left eye; eye_x: of its centre, mm
Points lens_rim(const Sheet& sheet, int side, double eye_x, double eye_y, int sign, float level) {
    const auto place_of = [&](int y, int x) {
        const double radius = kSmallest + y, angle = -(kFirst + kStep * x) * std::numbers::pi / 180;
        return Eigen::Vector2d(eye_x + side * radius * std::cos(angle), eye_y + radius * std::sin(angle));
    };
    const int columns = (kLast - kFirst) / kStep + 1;
    const cv::Mat1f values = sheet.shown(kLargest - kSmallest + 1, columns, place_of);
    const Path path = best_path(line_contrast(values, sign, level));
    Points rim(columns, 3);
    for (int x = 0; x < columns; ++x) {
        const Eigen::Vector2d mm = place_of(path.rows[static_cast<std::size_t>(x)], x);
        rim.row(x) = sheet.place(mm.x(), mm.y());
    }
    return rim;
}

/// How bright the skin below the eyes is, grey levels.
float skin_level(const Sheet& sheet) {
    cv::Mat1f values = sheet.shown(kHighest - kLowest + 1, 2 * kOuter + 1,
                                   [](int y, int x) { return Eigen::Vector2d(x - kOuter, kHighest - y); });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.total() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return std::max(kDimmest, *middle);
}

}  // namespace

std::vector<Points> glasses_rims(const ColorView& image, const Camera& camera,
                                 const Eigen::Isometry3d& camera_from_head, const Points& eyes) {
    if (image.rows != camera.height || image.cols != camera.width) {
        throw InvalidInput("the image is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " pixels but the camera's is " + std::to_string(camera.width) + " x " +
                           std::to_string(camera.height));
    }
    if (eyes.rows() != 2) {
        throw InvalidInput("eyes must be 2 x 3");
    }
    for (const Eigen::Index eye : {0, 1}) {
        const double depth = (camera_from_head * Eigen::Vector3d(eyes.row(eye))).z();
        if (!(depth > kNearest)) return {};
    }
    const Sheet sheet(image, camera, camera_from_head, eyes);
    const float level = skin_level(sheet);
    float strongest = kRim;
    std::optional<Path> bridge;
    int sign = 0;
    for (const int one : {-1, 1}) {
        const Path left = line_between(sheet, kInner, kOuter, kHighest, kLowest, one, level);
        const Path right = line_between(sheet, -kOuter, -kInner, kHighest, kLowest, one, level);
        const Path over = line_between(sheet, -kNose, kNose, kBridgeTop, kBridgeBottom, one, level);
        const float faintest = std::min({left.mean, right.mean, over.mean});
        if (faintest >= strongest) {
            strongest = faintest;
            bridge = over;
            sign = one;
        }
    }
    if (!bridge) return {};
    std::vector<Points> rims;
    const Eigen::RowVector3d middle = eyes.colwise().mean();
    for (const int eye : {0, 1}) {
        const Eigen::RowVector3d from_middle = (eyes.row(eye) - middle) / kMm;
        rims.push_back(lens_rim(sheet, eye == 0 ? 1 : -1, from_middle.x(), from_middle.y(), sign, level));
    }
    Points over(static_cast<Eigen::Index>(bridge->rows.size()), 3);
    for (Eigen::Index x = 0; x < over.rows(); ++x) {
        over.row(x) = sheet.place(static_cast<double>(x) - kNose,
                                  kBridgeTop - bridge->rows[static_cast<std::size_t>(x)]);
    }
    rims.push_back(over);
    return rims;
}

}  // namespace mimetic
