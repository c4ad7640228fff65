// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_look.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>

#include "crop_picture.hpp"
#include "shared/gray.hpp"

namespace mimetic::locate {
namespace {

constexpr double kBlur = .8;  // pixels of the grid
constexpr double kFine = 6;   // pixels of the grid, of what is about a place
constexpr float kUnlike = 5;  // grey levels from which on a place of two faces is not the same
constexpr int kStride = 4;    // pixels of the grid between those that are compared
constexpr double kSeen = .7;  // of the square's side to each side of its middle that is looked at

cv::Mat2f slopes_of(const cv::Mat1f& gray) {
    cv::Mat1f right, down;
    const cv::Mat kernel = (cv::Mat_<float>(1, 3) << -.5F, 0, .5F);
    cv::filter2D(gray, right, CV_32F, kernel);
    cv::filter2D(gray, down, CV_32F, kernel.t());
    cv::Mat2f slopes;
    cv::merge(std::vector<cv::Mat1f>{right, down}, slopes);
    return slopes;
}

/// The part of a frame on the grid, `scale` pixels of which make one of the picture.
cv::Mat1f on_grid(const ColorView& image, const cv::Rect& place, double scale) {
    // Of a large face blocks of so many pixels are averaged first: to blur each of them would take longer
    const int block = std::max(1, static_cast<int>(.5 / scale));
    const double step = 1 / (scale * block);  // blocks from a place of the grid to the next
    const double margin = 3 * step;           // as far as the blur reaches
    const cv::Rect asked(cv::Point(static_cast<int>(std::floor(place.x * step - margin)),
                                   static_cast<int>(std::floor(place.y * step - margin))),
                         cv::Point(static_cast<int>(std::ceil(place.br().x * step + margin)),
                                   static_cast<int>(std::ceil(place.br().y * step + margin))));
    const cv::Rect part = asked & cv::Rect(0, 0, image.cols / block, image.rows / block);
    const ColorView view{
        image.data + std::ptrdiff_t{block} * (part.y * image.stride + std::ptrdiff_t{3} * part.x),
        block * part.height, block * part.width, image.stride};
    cv::Mat1b blocks;
    cv::resize(to_gray(view), blocks, part.size(), 0, 0, cv::INTER_AREA);
    cv::Mat1f gray;
    blocks.convertTo(gray, CV_32F);
    cv::GaussianBlur(gray, gray, {}, kBlur * step);
    // Pixels have their middles at whole numbers, and so have blocks
    const double first = (1. / block - 1) / 2;
    const cv::Matx23d to_part(step, 0, place.x * step + first - part.x, 0, step,
                              place.y * step + first - part.y);
    cv::Mat1f grid;
    cv::warpAffine(gray, grid, to_part, place.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return grid;
}

/// The similarity that takes points of one look to where another has them.
Eigen::Affine2d between(const FaceLook& from, const FaceLook& to) {
    std::vector<Eigen::Vector2d> here, there;
    for (const Feature& point : from.points) {
        const auto same = std::ranges::find(to.points, point.name, &Feature::name);
        if (same != to.points.end()) {
            here.push_back(point.position);
            there.push_back(same->position);
        }
    }
    if (here.size() >= 3) {
        const auto as_columns = [](const std::vector<Eigen::Vector2d>& points) {
            return Eigen::Map<const Eigen::Matrix2Xd>(points.front().data(), 2,
                                                      static_cast<Eigen::Index>(points.size()));
        };
        const Eigen::Affine2d found(Eigen::umeyama(as_columns(here), as_columns(there)));
        constexpr double kMostGrowth = 4;  // of the area: points that fall together have no similarity
        if (found.matrix().allFinite() && found.linear().determinant() > 1 / kMostGrowth &&
            found.linear().determinant() < kMostGrowth) {
            return found;
        }
    }
    return Eigen::Translation2d(to.square.center) * Eigen::Rotation2Dd(to.square.roll - from.square.roll) *
           Eigen::Scaling(to.square.side / from.square.side) * Eigen::Translation2d(-from.square.center);
}

/// Places of a look's face, some of them, and what is fine there.
struct Sampled {
    explicit Sampled(const FaceLook& look) {
        for (int y = look.place.y; y < look.place.br().y; y += kStride) {
            for (int x = look.place.x; x < look.place.br().x; x += kStride) {
                if (look.is_face(y, x)) {
                    places.emplace_back(x, y);
                    fine.push_back(look.fine(y - look.place.y, x - look.place.x));
                }
            }
        }
    }
    std::vector<Eigen::Vector2f> places;
    std::vector<float> fine;
};

/// How unlike a face is in another look: 0 to `kUnlike` grey levels.
float unlike(const Sampled& face, const FaceLook& other, const Eigen::Affine2d& to_other) {
    const Eigen::Affine2f there = to_other.cast<float>();
    float sum = 0;
    for (std::size_t i = 0; i < face.places.size(); ++i) {
        const Eigen::Vector2f place = there * face.places[i];
        const cv::Point at(static_cast<int>(std::lround(place.x())),
                           static_cast<int>(std::lround(place.y())));
        sum += other.place.contains(at)
                   ? std::min(kUnlike, std::abs(face.fine[i] - other.fine(at - other.place.tl())))
                   : kUnlike;
    }
    return face.places.empty() ? kUnlike : sum / static_cast<float>(face.places.size());
}

/// To another look; see `aligned`.
Eigen::Affine2d aligned_to(const FaceLook& other, const FaceLook& one, const Sampled& face) {
    const Eigen::Vector2d middle = one.square.center;
    const double radius = .3 * one.square.side;
    const auto moved = [&](const Eigen::Affine2d& from, int way, double step) {
        Eigen::Affine2d by = Eigen::Affine2d::Identity();
        const double turn = step / radius;
        switch (way) {
            case 0:
                by.translation().x() = step;
                break;
            case 1:
                by.translation().y() = step;
                break;
            case 2:
                by.linear() *= 1 + turn;
                break;
            default:
                by.linear() = Eigen::Rotation2Dd(turn).toRotationMatrix();
                break;
        }
        const Eigen::Vector2d there = from * middle;
        return Eigen::Affine2d(Eigen::Translation2d(there) * by * Eigen::Translation2d(-there) * from);
    };
    Eigen::Affine2d best = between(one, other);
    float least = unlike(face, other, best);
    if (const float still = unlike(face, other, Eigen::Affine2d::Identity()); still < least) {
        best = Eigen::Affine2d::Identity();
        least = still;
    }
    for (double step = 2; step > .4; step /= 2) {
        for (bool is_better = true; is_better;) {
            is_better = false;
            for (int way = 0; way < 8; ++way) {
                const Eigen::Affine2d next = moved(best, way / 2, way % 2 == 0 ? step : -step);
                if (const float now = unlike(face, other, next); now < least) {
                    best = next;
                    least = now;
                    is_better = true;
                }
            }
        }
    }
    return best;
}

}  // namespace

const cv::Vec2f* FaceLook::slope_at(int y, int x) const {
    const cv::Point there(x, y);
    return place.contains(there) ? &slopes(there - place.tl()) : nullptr;
}

double FaceLook::outward(int y, int x) const {
    return outward_of_face(in_crop(Eigen::Vector2d(x, y), square));
}

FaceLook look_at(const ColorView& image, const FeatureCrop& square, const std::vector<Feature>& points,
                 double scale) {
    FaceLook look{square, points, {}, {}, {}};
    look.square.center *= scale;
    look.square.side *= scale;
    for (Feature& point : look.points) {
        point.position *= scale;
    }
    const Eigen::Array2d size(std::floor(image.cols * scale), std::floor(image.rows * scale));
    // A face much nearer than the first is cut off, so that no frame takes more than its share
    const double half = kSeen * std::min(look.square.side, 2 * kGridSide);
    const Eigen::Array2i begin = (look.square.center.array() - half).max(0).min(size).cast<int>();
    const Eigen::Array2i end = (look.square.center.array() + half).max(0).min(size).cast<int>();
    look.place = {begin.x(), begin.y(), end.x() - begin.x(), end.y() - begin.y()};
    if (look.place.empty()) {
        return look;
    }
    const cv::Mat1f gray = on_grid(image, look.place, scale);
    cv::Mat1f about;
    cv::GaussianBlur(gray, about, {}, kFine);
    look.slopes = slopes_of(gray);
    look.fine = gray - about;
    return look;
}

std::vector<Eigen::Affine2d> aligned(const FaceLook& one, const std::vector<FaceLook>& looks) {
    const Sampled face(one);
    std::vector<Eigen::Affine2d> to_looks;
    to_looks.reserve(looks.size());
    for (const FaceLook& look : looks) {
        to_looks.push_back(aligned_to(look, one, face));
    }
    return to_looks;
}

}  // namespace mimetic::locate
