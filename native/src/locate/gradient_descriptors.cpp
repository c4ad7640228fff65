// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <mimetic/locate/landmarks.hpp>
#include <mimetic/shared/checks.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "shared/as_matrix.hpp"

namespace mimetic {
namespace {

constexpr double kPxPerIpd = 40;  // of the level picture
constexpr int kOrientations = 8;
constexpr int kSide = 4;               // places of a descriptor along each axis
constexpr double kMargin = 0.7;        // IPD about the reference
constexpr double kPreBlur = 0.8;       // pixels
constexpr double kBlurPerCell = 0.5;   // s.d. of what one place of a descriptor sums up
constexpr float kQuiet = 0.25F;        // of the face's mean contrast: what counts as flat
constexpr float kLargestShare = 0.3F;  // of one value in a descriptor [Lowe 2004]
constexpr int kMostSide = 400;         // pixels of the level picture
using Cells = cv::Vec<float, kOrientations>;

/// The picture turned, sized and cut so that reference places have fixed pixels.
struct LevelPicture {
    cv::Mat1f luminance;
    Eigen::Vector2d corner;  // of the reference, IPD

    Eigen::Vector2d pixel(const Eigen::Vector2d& in_reference) const {
        return kPxPerIpd * (in_reference - corner);
    }
};

LevelPicture level(ColorView image, const Eigen::Matrix<double, 2, 3>& image_from_reference,
                   Points2In reference) {
    LevelPicture out;
    out.corner = reference.colwise().minCoeff().transpose().array() - kMargin;
    const Eigen::Vector2d far = reference.colwise().maxCoeff().transpose().array() + kMargin;
    const cv::Size size(std::min(kMostSide, static_cast<int>(std::ceil(kPxPerIpd * (far - out.corner).x()))),
                        std::min(kMostSide, static_cast<int>(std::ceil(kPxPerIpd * (far - out.corner).y()))));
    const Eigen::Matrix2d turn = image_from_reference.leftCols<2>() / kPxPerIpd;
    const Eigen::Vector2d origin = image_from_reference * Eigen::Vector3d(out.corner.x(), out.corner.y(), 1);
    // Only what the level picture shows is converted and shrunk
    Eigen::Array2d low = origin, high = origin;
    for (const auto& end : {Eigen::Vector2d(size.width, 0), Eigen::Vector2d(0, size.height),
                            Eigen::Vector2d(size.width, size.height)}) {
        low = low.min((origin + turn * end).array());
        high = high.max((origin + turn * end).array());
    }
    const auto clamped = [](double value, int most) {
        return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
    };
    const cv::Point first(clamped(low.x() - 4, image.cols - 1), clamped(low.y() - 4, image.rows - 1));
    const cv::Point last(std::max(first.x + 1, clamped(high.x() + 5, image.cols)),
                         std::max(first.y + 1, clamped(high.y() + 5, image.rows)));
    const cv::Mat whole = as_matrix(image);
    cv::Mat gray;
    cv::cvtColor(whole(cv::Rect(first, last)), gray, cv::COLOR_RGB2GRAY);
    double factor = 1;
    // The warp alone would alias
    for (double scale = turn.col(0).norm(); scale > 1.7 && std::min(gray.rows, gray.cols) > 8; scale /= 2) {
        cv::Mat half;
        cv::resize(gray, half, {}, 0.5, 0.5, cv::INTER_AREA);
        gray = half;
        factor *= 2;
    }
    const Eigen::Vector2d start = (origin - Eigen::Vector2d(first.x, first.y)).array() + 0.5;
    const cv::Matx23d warp(turn(0, 0) / factor, turn(0, 1) / factor, start.x() / factor - 0.5,
                           turn(1, 0) / factor, turn(1, 1) / factor, start.y() / factor - 0.5);
    cv::Mat warped;
    cv::warpAffine(gray, warped, warp, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    warped.convertTo(out.luminance, CV_32F, 1.0 / 255);
    cv::GaussianBlur(out.luminance, out.luminance, {}, kPreBlur, kPreBlur, cv::BORDER_REPLICATE);
    return out;
}

/// Strength of the gradient by orientation, each shared between its two neighbours, summed over a cell.
cv::Mat oriented(const cv::Mat1f& luminance, double blur) {
    cv::Mat out(luminance.size(), CV_32FC(kOrientations), cv::Scalar::all(0));
    for (int y = 0; y < luminance.rows; ++y) {
        const float* above = luminance[std::max(0, y - 1)];
        const float* below = luminance[std::min(luminance.rows - 1, y + 1)];
        const float* here = luminance[y];
        for (int x = 0; x < luminance.cols; ++x) {
            const float right = here[std::min(luminance.cols - 1, x + 1)] - here[std::max(0, x - 1)];
            const float down = below[x] - above[x];
            const float strength = std::hypot(right, down);
            if (strength < 1e-6F) continue;
            const auto turn =
                static_cast<float>((std::atan2(down, right) / std::numbers::pi + 1) * kOrientations / 2);
            const int lower = static_cast<int>(turn) % kOrientations;
            const float share = turn - std::floor(turn);
            auto& cells = out.at<Cells>(y, x);
            cells[lower] = (1 - share) * strength;
            cells[(lower + 1) % kOrientations] = share * strength;
        }
    }
    cv::Mat blurred;
    cv::GaussianBlur(out, blurred, {}, blur, blur, cv::BORDER_REPLICATE);
    return blurred;
}

Cells sample(const cv::Mat& cells, const Eigen::Vector2d& at) {
    const double x = std::clamp(at.x(), 0.0, cells.cols - 1.001);
    const double y = std::clamp(at.y(), 0.0, cells.rows - 1.001);
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
    const auto value = [&](int row, int col) { return cells.at<Cells>(row, col); };
    return (1 - fy) * ((1 - fx) * value(top, left) + fx * value(top, left + 1)) +
           fy * ((1 - fx) * value(top + 1, left) + fx * value(top + 1, left + 1));
}

}  // namespace

Eigen::Matrix<double, 2, 3> similarity(Points2In from, Points2In to) {
    const Eigen::RowVector2d middle = from.colwise().mean(), aim = to.colwise().mean();
    const Points2 a = from.rowwise() - middle, b = to.rowwise() - aim;
    const double size = std::max(a.squaredNorm(), 1e-12);
    const double c = a.cwiseProduct(b).sum() / size;
    const double s = (a.col(0).dot(b.col(1)) - a.col(1).dot(b.col(0))) / size;
    Eigen::Matrix<double, 2, 3> out;
    out.leftCols<2>() << c, -s, s, c;
    out.col(2) = aim.transpose() - out.leftCols<2>() * middle.transpose();
    return out;
}

MatrixRows landmark_descriptors(ColorView image, Points2In places, Points2In reference, double cell) {
    require(
        places.rows() > 0 && places.rows() == reference.rows() && places.allFinite() && reference.allFinite(),
        "each landmark needs a place and one of reference, both finite");
    check_range("cell", cell, 0, 10);
    const auto image_from_reference = similarity(reference, places);
    require(std::abs(image_from_reference.leftCols<2>().determinant()) > 0,
            "the landmarks are all in one place");
    const Eigen::Matrix2d back = image_from_reference.leftCols<2>().inverse();
    const LevelPicture picture = level(image, image_from_reference, reference);
    const cv::Mat cells = oriented(picture.luminance, kBlurPerCell * cell * kPxPerIpd);
    const auto count = places.rows();
    Eigen::Matrix<float, Eigen::Dynamic, kDescriptor, Eigen::RowMajor> rows(count, kDescriptor);
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector2d at = back * (places.row(i).transpose() - image_from_reference.col(2));
        for (int k = 0; k < kSide * kSide; ++k) {
            const Eigen::Vector2d off(k % kSide - 0.5 * (kSide - 1), k / kSide - 0.5 * (kSide - 1));
            const Cells seen = sample(cells, picture.pixel(at + cell * off));
            for (int o = 0; o < kOrientations; ++o) rows(i, kOrientations * k + o) = seen[o];
        }
    }
    const float contrast = rows.rowwise().squaredNorm().mean();
    const float quiet = kQuiet * kQuiet * contrast + 1e-12F;
    for (int i = 0; i < count; ++i) {
        auto row = rows.row(i);
        row /= std::sqrt(row.squaredNorm() + quiet);
        const float norm = row.norm();
        row = row.cwiseMin(kLargestShare * norm);
        if (row.norm() > 0) row *= norm / row.norm();
    }
    return rows.cast<double>();
}

}  // namespace mimetic
