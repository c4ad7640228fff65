// SPDX-License-Identifier: GPL-3.0-or-later
#include "cover.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace mimetic {

namespace {

constexpr double kHidden = .2;  // probability beyond the usual from which skin counts as hidden

/// The largest of each cell and its eight neighbours: the square follows the head within a cell.
Eigen::MatrixXf grown(const Eigen::MatrixXf& cells) {
    Eigen::MatrixXf largest = cells;
    for (Eigen::Index row = 0; row < cells.rows(); ++row) {
        for (Eigen::Index column = 0; column < cells.cols(); ++column) {
            const Eigen::Index top = std::max<Eigen::Index>(row - 1, 0);
            const Eigen::Index left = std::max<Eigen::Index>(column - 1, 0);
            const Eigen::Index height = std::min(row + 2, cells.rows()) - top;
            const Eigen::Index width = std::min(column + 2, cells.cols()) - left;
            largest(row, column) = cells.block(top, left, height, width).maxCoeff();
        }
    }
    return largest;
}

/// Makes the parts of the face 0 that hang together and are surely hidden nowhere: a laugh and other light
/// are perhaps something before it, all over the mouth; of a hand or a microphone the network is sure.
/// beyond: by how much more than usual each cell is hidden, with a probability that was seen.
void drop_unsure_parts(const Eigen::MatrixXf& seen, Eigen::MatrixXf& beyond) {
    constexpr int kLeastSure = 2;  // cells
    const auto rows = static_cast<int>(beyond.rows()), columns = static_cast<int>(beyond.cols());
    cv::Mat1b hidden(rows, columns);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const bool is_face = outward_of_face({(x + .5) / columns, (y + .5) / rows}) < 1;
            hidden(y, x) = is_face && beyond(y, x) > kHidden ? 1 : 0;
        }
    }
    cv::Mat1i part;
    std::vector<int> num_sure(static_cast<std::size_t>(cv::connectedComponents(hidden, part, 8, CV_32S)));
    const auto number_of = [&part](int y, int x) { return static_cast<std::size_t>(part(y, x)); };
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            num_sure[number_of(y, x)] += seen(y, x) > static_cast<float>(Occlusion::kSure) ? 1 : 0;
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            if (hidden(y, x) != 0 && num_sure[number_of(y, x)] < kLeastSure) {
                beyond(y, x) = 0;
            }
        }
    }
}

/// 1 in cells of a face's square that what stands still in the picture is in, by their middles and those of
/// their quarters, else 0.
Eigen::MatrixXf cells_in(const StillCover& still, const Occlusion& seen) {
    Eigen::MatrixXf in = Eigen::MatrixXf::Zero(seen.cells.rows(), seen.cells.cols());
    for (Eigen::Index row = 0; still.any() && row < in.rows(); ++row) {
        for (Eigen::Index column = 0; column < in.cols(); ++column) {
            const auto is_at = [&](double down, double right) {
                return still.at(
                    seen.pixel_of(static_cast<double>(row) + down, static_cast<double>(column) + right));
            };
            const bool is_any =
                is_at(0, 0) || is_at(-.25, -.25) || is_at(-.25, .25) || is_at(.25, -.25) || is_at(.25, .25);
            in(row, column) = is_any ? 1.F : 0.F;
        }
    }
    return in;
}

}  // namespace

Cover::Cover(OcclusionSource source, StillCover still, const ColorView& image,
             const Eigen::Isometry3d& camera_from_head)
    : source_(std::move(source)), still_(std::move(still)) {
    look(image, camera_from_head);
    usual_ = grown(seen_.cells);
    const double surely = seen_.is_sure() ? Occlusion::kSure : 1;
    first_ = (seen_.cells.array() > static_cast<float>(surely)).cast<float>().matrix();
    first_ = first_.cwiseMax(cells_in(still_, seen_));
    look_away();
}

void Cover::look(const ColorView& image, const Eigen::Isometry3d& camera_from_head) {
    if (!source_) {
        return;
    }
    seen_ = source_(image, camera_from_head);
    behind_ = seen_.cells.size() > 0 ? Occlusion{seen_.square, first_} : Occlusion{};
    if (usual_.size() > 0 && seen_.cells.size() > 0) {
        const Eigen::MatrixXf seen = seen_.cells;
        seen_.cells -= usual_;
        drop_unsure_parts(seen, seen_.cells);
    }
}

void Cover::look_away() { seen_ = behind_ = {}; }

void Cover::dismiss() { seen_ = {}; }

bool Cover::hides_any() const {
    return still_.any() || (seen_.cells.size() > 0 && seen_.cells.maxCoeff() > kHidden) ||
           (behind_.cells.size() > 0 && behind_.cells.maxCoeff() > 0);
}

bool Cover::came(const Eigen::Vector2d& pixel) const { return seen_.at(pixel) > kHidden; }

bool Cover::was_hidden(const Eigen::Vector2d& pixel) const {
    constexpr double kNear = .25;  // of a cell's width: what is beside it is half hidden, too
    return behind_.at(pixel) > kNear;
}

}  // namespace mimetic
