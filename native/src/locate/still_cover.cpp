// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iterator>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/still_cover.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "face_look.hpp"
#include "shared/robust.hpp"

namespace mimetic {
namespace {

using locate::FaceLook;

constexpr std::size_t kFewest = 6;  // frames
constexpr double kShown = .6;       // share of the frames that show the face at a pixel
constexpr double kHave = .2;        // quantile: four frames of five have the edge
constexpr float kLeastEdge = 4;     // grey levels a pixel of the grid
constexpr float kStrongEdge = 12;   // the same of what is not seen through
constexpr float kBeyondFace = 1.5;  // times the gradient that the face itself has there in any frame
constexpr int kReach = 1;           // pixels of the grid within which a similarity follows a head that turns
constexpr int kCell = 5;            // pixels of the grid
constexpr int kLeastInCell = 3;     // of its pixels
constexpr int kLeastCells = 4;      // within the face that touch each other: less is chance
constexpr double kInner = .8;       // of the way from the face's middle to its outline
constexpr int kLargestSide = 400;   // cells of a side

/// The gradient that looks have in common: along their median, what but a few reach; 0 where too few show it.
/// slope_in: a look's (its number) at the place in question, or nullptr.
template <typename SlopeIn>
float common_slope(std::size_t num_looks, const SlopeIn& slope_in) {
    std::vector<cv::Vec2f> slopes;
    for (std::size_t k = 0; k < num_looks; ++k) {
        if (const cv::Vec2f* slope = slope_in(k); slope != nullptr) {
            slopes.push_back(*slope);
        }
    }
    if (static_cast<double>(slopes.size()) < std::max(4., kShown * static_cast<double>(num_looks))) {
        return 0;
    }
    std::vector<float> right, down, along;
    for (const cv::Vec2f& slope : slopes) {
        right.push_back(slope[0]);
        down.push_back(slope[1]);
    }
    const cv::Vec2f middle(upper_median(right), upper_median(down));
    const auto length = static_cast<float>(cv::norm(middle));
    if (length < 1e-6F) {
        return 0;
    }
    for (const cv::Vec2f& slope : slopes) {
        along.push_back(slope.dot(middle) / length);
    }
    const auto few = along.begin() + static_cast<std::ptrdiff_t>(kHave * static_cast<double>(along.size()));
    std::nth_element(along.begin(), few, along.end());
    return std::max(0.F, *few);
}

/// What gradient the face itself has, in a picture in which it moves; computed where it is asked for.
class SlopesOfFace {
public:
    explicit SlopesOfFace(const std::vector<FaceLook>& looks)
        : looks_(looks), about_(looks[looks.size() / 2]) {
        from_about_ = locate::aligned(about_, looks);
        for (const Eigen::Affine2d& to_look : from_about_) {
            to_about_.push_back(to_look.inverse());
        }
        common_ = cv::Mat1f(about_.place.size(), kUnknown);
    }

    /// The largest at a place of the picture, wherever the face is in any of the looks.
    float largest_at(int y, int x) {
        float largest = 0;
        for (const Eigen::Affine2d& one : to_about_) {
            const Eigen::Vector2d there = one * Eigen::Vector2d(x, y);
            const cv::Point at(static_cast<int>(std::lround(there.x())) - about_.place.x,
                               static_cast<int>(std::lround(there.y())) - about_.place.y);
            const cv::Rect near = cv::Rect(at.x - kReach, at.y - kReach, 2 * kReach + 1, 2 * kReach + 1) &
                                  cv::Rect({}, common_.size());
            for (int row = near.y; row < near.br().y; ++row) {
                for (int column = near.x; column < near.br().x; ++column) {
                    largest = std::max(largest, common_at(row, column));
                }
            }
        }
        return largest;
    }

private:
    static constexpr float kUnknown = -1;

    float common_at(int row, int column) {
        float& common = common_(row, column);
        if (common == kUnknown) {
            const Eigen::Vector2d here(column + about_.place.x, row + about_.place.y);
            common = common_slope(looks_.size(), [&](std::size_t k) {
                const Eigen::Vector2d there = from_about_[k] * here;
                return looks_[k].slope_at(static_cast<int>(std::lround(there.y())),
                                          static_cast<int>(std::lround(there.x())));
            });
        }
        return common;
    }

    const std::vector<FaceLook>& looks_;
    const FaceLook& about_;  // the look on whose grid the face's own gradients are
    std::vector<Eigen::Affine2d> from_about_, to_about_;
    cv::Mat1f common_;
};

/// Gradients of the picture that are not the face's, in `all`, a part of the grid; 0 elsewhere.
cv::Mat1f still_edges(const std::vector<FaceLook>& looks, const cv::Rect& all) {
    SlopesOfFace of_face(looks);
    cv::Mat1f edges = cv::Mat1f::zeros(all.size());
    for (int y = all.y; y < all.br().y; ++y) {
        for (int x = all.x; x < all.br().x; ++x) {
            const float slope = common_slope(looks.size(), [&](std::size_t k) {
                return looks[k].is_face(y, x) ? looks[k].slope_at(y, x) : nullptr;
            });
            if (slope > kLeastEdge && slope > kBeyondFace * of_face.largest_at(y, x)) {
                edges(y - all.y, x - all.x) = slope;
            }
        }
    }
    return edges;
}

/// No cell yet, of those that a part of the grid divides into.
cv::Mat1b cells_over(const cv::Size& part) {
    return cv::Mat1b::zeros((part.height + kCell - 1) / kCell, (part.width + kCell - 1) / kCell);
}

/// 1 in cells that hold as steep edges.
cv::Mat1b cells_with(const cv::Mat1f& edges, float least) {
    cv::Mat1b cells = cells_over(edges.size());
    const cv::Rect all({}, edges.size());
    for (int y = 0; y < cells.rows; ++y) {
        for (int x = 0; x < cells.cols; ++x) {
            const cv::Rect cell = cv::Rect(x * kCell, y * kCell, kCell, kCell) & all;
            cells(y, x) = cv::countNonZero(edges(cell) > least) >= kLeastInCell;
        }
    }
    return cells;
}

/// 1 in cells whose middles are well within the face in most looks: along its outline a head that turns shows
/// an edge that stays where it is.
cv::Mat1b inner_cells(const std::vector<FaceLook>& looks, const cv::Rect& all) {
    cv::Mat1b cells = cells_over(all.size());
    for (int y = 0; y < cells.rows; ++y) {
        for (int x = 0; x < cells.cols; ++x) {
            const auto inside = std::ranges::count_if(looks, [&](const FaceLook& look) {
                return look.outward(all.y + kCell * y + kCell / 2, all.x + kCell * x + kCell / 2) < kInner;
            });
            cells(y, x) = static_cast<double>(inside) >= kShown * static_cast<double>(looks.size());
        }
    }
    return cells;
}

/// Cells that hold edges and touch others, some of them `inner`. About strong ones nothing is measured
/// either, between letters; what is seen through spoils little beside it.
cv::Mat1b cells_of(const cv::Mat1f& edges, const cv::Mat1b& inner) {
    cv::Mat1b cells = cells_with(edges, kLeastEdge);
    cv::Mat1i labels;
    std::vector<int> num_inner(static_cast<std::size_t>(cv::connectedComponents(cells, labels, 8, CV_32S)));
    for (int y = 0; y < cells.rows; ++y) {
        for (int x = 0; x < cells.cols; ++x) {
            num_inner[static_cast<std::size_t>(labels(y, x))] += inner(y, x);
        }
    }
    for (int y = 0; y < cells.rows; ++y) {
        for (int x = 0; x < cells.cols; ++x) {
            if (num_inner[static_cast<std::size_t>(labels(y, x))] < kLeastCells) {
                cells(y, x) = 0;
            }
        }
    }
    cv::Mat1b strong = cells_with(edges, kStrongEdge) & cells;
    cv::dilate(strong, strong, cv::Mat1b::ones(3, 3));
    return cells | strong;
}

/// Those whose face is within its own size of where it is in most: of two people who are found in turn one
/// would seem to move from the one's place to the other's, and leave the features there.
std::vector<FaceLook> of_one_face(const std::vector<FaceLook>& looks) {
    std::vector<double> across, down;
    for (const FaceLook& look : looks) {
        across.push_back(look.square.center.x());
        down.push_back(look.square.center.y());
    }
    const Eigen::Vector2d usual(upper_median(across), upper_median(down));
    std::vector<FaceLook> near;
    std::ranges::copy_if(looks, std::back_inserter(near), [&](const FaceLook& look) {
        return (look.square.center - usual).norm() < look.square.side;
    });
    return near;
}

}  // namespace

bool StillCover::at(const Eigen::Vector2d& pixel) const {
    const Eigen::Array2d place = ((pixel - corner) / cell).array().floor();
    if (!(place >= 0).all() || !(place.x() < static_cast<double>(cells.cols())) ||
        !(place.y() < static_cast<double>(cells.rows()))) {
        return false;
    }
    return cells(static_cast<Eigen::Index>(place.y()), static_cast<Eigen::Index>(place.x()));
}

void StillCover::check() const {
    require(corner.allFinite(), "the corner of what stands still in the picture must be finite");
    check_range("the cells' side of what stands still in the picture", cell, .1, kLargestImage);
    require(std::max(cells.rows(), cells.cols()) <= kLargestSide,
            "what stands still in the picture has more than " + std::to_string(kLargestSide) +
                " cells to a side");
}

struct StillCoverWatch::Looks {
    int rows = 0, cols = 0;
    double scale = 1;  // pixels of the grid for one of the picture
    std::vector<FaceLook> looks;
};

StillCoverWatch::StillCoverWatch() : looks_(std::make_unique<Looks>()) {}
StillCoverWatch::~StillCoverWatch() = default;
StillCoverWatch::StillCoverWatch(StillCoverWatch&&) noexcept = default;
StillCoverWatch& StillCoverWatch::operator=(StillCoverWatch&&) noexcept = default;

void StillCoverWatch::add(const ColorView& image, const FaceFeatures& face) {
    check_image_size(image.rows, image.cols, "image");
    const FeatureCrop square = occlusion_square(face);
    square.check();
    Looks& all = *looks_;
    if (all.looks.empty()) {
        all.rows = image.rows;
        all.cols = image.cols;
        all.scale = std::min(1., locate::kGridSide / square.side);
    }
    require(image.rows == all.rows && image.cols == all.cols, "frames of one clip must be of one size");
    FaceLook look = locate::look_at(image, square, face.features, all.scale);
    if (!look.place.empty()) {
        all.looks.push_back(std::move(look));
    }
}

StillCover StillCoverWatch::found() const {
    const std::vector<FaceLook> looks = of_one_face(looks_->looks);
    if (looks.size() < kFewest) {
        return {};
    }
    cv::Rect all = looks.front().place;
    for (const FaceLook& look : looks) {
        all |= look.place;
    }
    const cv::Mat1b everywhere = cells_of(still_edges(looks, all), inner_cells(looks, all));
    const cv::Rect part = cv::boundingRect(everywhere);
    if (part.empty()) {
        return {};
    }
    const cv::Mat1b cells = everywhere(part);
    // Pixels have their middles at whole numbers, of the grid as of the picture
    const Eigen::Vector2d corner(all.x + kCell * part.x - .5, all.y + kCell * part.y - .5);
    StillCover found{corner / looks_->scale, kCell / looks_->scale, {}};
    found.cells.resize(cells.rows, cells.cols);
    for (int y = 0; y < cells.rows; ++y) {
        for (int x = 0; x < cells.cols; ++x) {
            found.cells(y, x) = cells(y, x) != 0;
        }
    }
    return found;
}

}  // namespace mimetic
