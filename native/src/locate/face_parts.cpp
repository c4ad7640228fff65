// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/face_parts.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mimetic::locate {
namespace {

constexpr double kReach = 2.5;        // deviations
constexpr double kMostReach = 0.15;   // widths of the face's window
constexpr int kSummits = 4;           // a module
constexpr double kRatioWeight = 0.2;  // pixels of a window are not independent: their ratio is overconfident

struct Summit {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< widths of the face's window
    double log_ratio = 0;
};

double parabola_top(double before, double here, double after) {
    const double curvature = before - 2 * here + after;
    if (!(curvature < -1e-9)) return 0;
    return std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5);
}

/// Local maxima of the ratios (rows x cols, from `corner` in pixels), the highest first.
std::vector<Summit> summits(const MatrixRows& ratio, const Eigen::Vector2d& corner, double px) {
    std::vector<Summit> found;
    const auto at = [&](Eigen::Index y, Eigen::Index x) {
        return x < 0 || y < 0 || x >= ratio.cols() || y >= ratio.rows()
                   ? -std::numeric_limits<double>::infinity()
                   : ratio(y, x);
    };
    for (Eigen::Index y = 0; y < ratio.rows(); ++y) {
        for (Eigen::Index x = 0; x < ratio.cols(); ++x) {
            const double here = ratio(y, x);
            bool highest = true;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) highest = highest && at(y + dy, x + dx) <= here;
            }
            if (!highest) continue;
            Eigen::Vector2d place(static_cast<double>(x), static_cast<double>(y));
            if (x > 0 && x + 1 < ratio.cols()) place.x() += parabola_top(at(y, x - 1), here, at(y, x + 1));
            if (y > 0 && y + 1 < ratio.rows()) place.y() += parabola_top(at(y - 1, x), here, at(y + 1, x));
            found.push_back({(corner + place) / px, here});
        }
    }
    std::sort(found.begin(), found.end(),
              [](const Summit& a, const Summit& b) { return a.log_ratio > b.log_ratio; });
    if (found.size() > kSummits) found.resize(kSummits);
    return found;
}

PartPlaces best_together(const std::vector<std::vector<Summit>>& sought, const ViewSpace& view) {
    const std::size_t count = sought.size();
    const Eigen::LLT<Eigen::MatrixXd> factor(view.covariance);
    std::vector<std::size_t> choice(count, 0), best;
    double highest = -std::numeric_limits<double>::infinity(), prior = 0;
    Eigen::VectorXd off(view.places.size());
    for (;;) {
        double total = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto at = static_cast<Eigen::Index>(2 * i);
            const Summit& summit = sought[i][choice[i]];
            off.segment<2>(at) = summit.place - view.places.segment<2>(at);
            total += kRatioWeight * summit.log_ratio;
        }
        const double here = factor.matrixL().solve(off).squaredNorm();
        if (best.empty() || total - 0.5 * here > highest) {
            best = choice;
            highest = total - 0.5 * here;
            prior = here;
        }
        std::size_t digit = 0;
        while (digit < count && ++choice[digit] == sought[digit].size()) choice[digit++] = 0;
        if (digit == count) break;
    }
    const auto rows = static_cast<Eigen::Index>(count);
    PartPlaces parts{Points2(rows, 2), Eigen::VectorXd(rows), prior};
    for (std::size_t i = 0; i < count; ++i) {
        parts.places.row(static_cast<Eigen::Index>(i)) = sought[i][best[i]].place;
        parts.log_ratio(static_cast<Eigen::Index>(i)) = sought[i][best[i]].log_ratio;
    }
    return parts;
}

}  // namespace

FaceParts::FaceParts(const FaceSpaces& spaces) {
    for (const auto& module : spaces.modules) {
        modules_.push_back({BatchSpace(module.space), BatchSpace(module.other),
                            cv::Size(module.space.width, module.space.height)});
    }
    if (!spaces.modules.empty()) px_ = spaces.modules[0].space.width / spaces.modules[0].width;
}

PartPlaces FaceParts::place(const Pyramid& pyramid, const Eigen::Vector2d& center, double width, double roll,
                            const ViewSpace& view) const {
    // One window holds what every module may reach
    double reach_x = 0, reach_y = 0;
    std::vector<Eigen::Array2i> reach;
    for (std::size_t i = 0; i < modules_.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(2 * i);
        const Eigen::Array2d deviation = view.covariance.diagonal().segment<2>(at).cwiseSqrt();
        reach.push_back((px_ * (kReach * deviation).min(kMostReach)).ceil().cast<int>());
        reach_x =
            std::max(reach_x, px_ * std::abs(view.places(at)) + reach[i].x() + 0.5 * modules_[i].size.width);
        reach_y = std::max(
            reach_y, px_ * std::abs(view.places(at + 1)) + reach[i].y() + 0.5 * modules_[i].size.height);
    }
    const cv::Size size(2 * static_cast<int>(std::ceil(reach_x)) + 2,
                        2 * static_cast<int>(std::ceil(reach_y)) + 2);
    const cv::Mat1f flat = pyramid.window(center, width / px_, roll, size, px_ / 2);
    const Eigen::Vector2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
    std::vector<std::vector<Summit>> sought;
    for (std::size_t i = 0; i < modules_.size(); ++i) {
        const Module& module = modules_[i];
        const Eigen::Vector2d half(0.5 * (module.size.width - 1), 0.5 * (module.size.height - 1));
        const Eigen::Vector2d mean = view.places.segment<2>(static_cast<Eigen::Index>(2 * i));
        const Eigen::Vector2i corner =
            ((middle + px_ * mean - half).array().round().cast<int>() - reach[i]).matrix();
        const int cols = 2 * reach[i].x() + 1, rows = 2 * reach[i].y() + 1;
        Windows windows(rows * cols, module.size.area());
        for (int k = 0; k < rows * cols; ++k) {
            const int x = corner.x() + k % cols, y = corner.y() + k / cols;
            for (int line = 0; line < module.size.height; ++line) {
                std::copy_n(flat[y + line] + x, module.size.width,
                            windows.data() + static_cast<Eigen::Index>(k) * windows.cols() +
                                static_cast<Eigen::Index>(line) * module.size.width);
            }
        }
        normalize_rows(windows);
        const Eigen::ArrayXf ratio =
            module.space.of(windows).log_likelihood - module.other.of(windows).log_likelihood;
        const MatrixRows map =
            Eigen::Map<const Rows<float, Eigen::Dynamic>>(ratio.data(), rows, cols).cast<double>();
        sought.push_back(summits(map, corner.cast<double>() + half - middle, px_));
    }
    return best_together(sought, view);
}

}  // namespace mimetic::locate
