// SPDX-License-Identifier: GPL-3.0-or-later
#include "opening_lines.hpp"

#include <array>
#include <span>

#include "seen_point.hpp"

namespace mimetic {

namespace {

constexpr double kLeastWidth = 3;  // pixels between the corners
// Where lines are compared. One line of a mouth has the corners, in which all of them end: on five real
// people the networks see how high they are to 1 % of the interpupillary distance, and flow sees a smile lift
// them by two thirds of its way (docs/measured/real-faces.md).
constexpr std::array kAlong{-.32, -.16, 0., .16, .32};
constexpr std::array kToCorners{-.5, -.32, -.16, 0., .16, .32, .5};

/// The stretch of a line that has a share of its way between its ends, by how far along their chord it is.
struct Stretch {
    Eigen::Index first = 0;  // point before
    double share = 0;        // of the way to the next
};

Stretch stretch_at(const Points2& line, double along) {
    const Eigen::Vector2d first = line.row(0), last = line.row(line.rows() - 1);
    const Eigen::Vector2d chord = (last - first) / (last - first).squaredNorm();
    const auto share_of = [&](Eigen::Index i) { return (line.row(i).transpose() - first).dot(chord) - .5; };
    if (along >= .5) {
        return {line.rows() - 2, 1};
    }
    Stretch stretch;
    for (Eigen::Index i = 0; i + 1 < line.rows(); ++i) {
        const double before = share_of(i), after = share_of(i + 1);
        if (before <= along && after > along) {
            stretch = {i, (along - before) / (after - before)};
        }
    }
    return stretch;
}

Eigen::Vector2d point_at(const Points2& line, const Stretch& stretch) {
    return (1 - stretch.share) * line.row(stretch.first).transpose() +
           stretch.share * line.row(stretch.first + 1).transpose();
}

/// Each place's distance from the middle of those of the meeting lines that are as far along; 0 of others.
Eigen::VectorXd from_middle(const Eigen::VectorXd& heights, const std::vector<LinePlace>& places) {
    Eigen::VectorXd distances = Eigen::VectorXd::Zero(heights.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        double sum = 0, number = 0;
        for (std::size_t j = 0; j < places.size(); ++j) {
            if (places[j].meets && places[j].along == places[i].along) {
                sum += heights[static_cast<Eigen::Index>(j)];
                ++number;
            }
        }
        if (places[i].meets) {
            distances[static_cast<Eigen::Index>(i)] = heights[static_cast<Eigen::Index>(i)] - sum / number;
        }
    }
    return distances;
}

}  // namespace

OpeningLines::OpeningLines(const FaceSurface& surface, const FeatureOpening& opening) : opening_(opening) {
    opening_.facing.normalize();
    const bool is_slit = opening.lines.size() == 2;
    for (const std::vector<int>& line : opening.lines) {
        std::vector<SkinPoint>& points = lines_.emplace_back();
        for (const int vertex : line) {
            points.push_back(surface.at_vertex(vertex));
        }
        const int number = static_cast<int>(lines_.size()) - 1;
        const bool has_corners = !is_slit && number == 0;
        for (const double along : has_corners ? std::span<const double>(kToCorners) : kAlong) {
            places_.push_back({number, along, is_slit || number == 1 || number == 2});
        }
    }
}

Eigen::Vector3d OpeningLines::middle() const {
    const std::vector<SkinPoint>& line = lines_.front();
    return (.5f * (line.front().neutral + line.back().neutral)).cast<double>();
}

std::optional<OpeningOffsets> OpeningLines::compare(const Camera& camera, const FaceState& state,
                                                    const SeenOpening& seen, double interpupillary) const {
    const Eigen::Vector3d middle_in_camera = state.camera_from_head * middle();
    if (seen.lines.size() != lines_.size() || !(middle_in_camera.z() > 1e-2)) {
        return {};
    }
    const auto count = static_cast<Eigen::Index>(places_.size());
    const double pixels = .5 * (camera.fx + camera.fy) / middle_in_camera.z() * interpupillary;
    OpeningOffsets result{Eigen::VectorXd(count),
                          Eigen::MatrixXd(count, state.values.size()),
                          Eigen::MatrixXd::Zero(count, lines_.front().front().detail_modes.cols()),
                          Eigen::VectorXd::Zero(count),
                          1 / pixels,
                          0};
    result.frontality =
        -(state.camera_from_head.linear() * opening_.facing).dot(middle_in_camera.normalized());
    const Eigen::VectorXf values = state.values.cast<float>();
    Eigen::Index row = 0;
    for (std::size_t l = 0; l < lines_.size(); ++l) {
        Points2 model(static_cast<Eigen::Index>(lines_[l].size()), 2);
        std::vector<Eigen::Vector3d> points;
        for (const SkinPoint& point : lines_[l]) {
            points.push_back((point.neutral + point.modes * values).cast<double>());
            model.row(static_cast<Eigen::Index>(points.size()) - 1) =
                camera.project(state.camera_from_head * points.back()).transpose();
        }
        const Points2& other = seen.lines[l];
        const Eigen::Vector2d chord = model.row(model.rows() - 1) - model.row(0);
        if (other.rows() < 2 || !other.allFinite() || !model.allFinite() || chord.norm() < kLeastWidth ||
            (other.row(other.rows() - 1) - other.row(0)).norm() < kLeastWidth) {
            return {};
        }
        const Eigen::Vector2d across = Eigen::Vector2d(-chord.y(), chord.x()).normalized();
        for (; row < count && places_[static_cast<std::size_t>(row)].line == static_cast<int>(l); ++row) {
            const double along = places_[static_cast<std::size_t>(row)].along;
            const Stretch here = stretch_at(model, along);
            const Eigen::Vector2d place_seen = point_at(other, stretch_at(other, along));
            result.offsets[row] = across.dot(place_seen - point_at(model, here)) / pixels;
            result.from_slit[row] = across.dot(place_seen) / pixels;
            result.by_values.row(row).setZero();
            for (const auto& [index, share] :
                 {std::pair{here.first, 1 - here.share}, std::pair{here.first + 1, here.share}}) {
                const auto vertex = static_cast<std::size_t>(index);
                const SeenPoint place(camera, state.camera_from_head, points[vertex]);
                const Eigen::RowVector3d by_point = across.transpose() * place.by_point * (share / pixels);
                result.by_values.row(row) += by_point * lines_[l][vertex].modes.cast<double>();
                result.by_detail.row(row) += by_point * lines_[l][vertex].detail_modes.cast<double>();
            }
        }
    }
    result.from_slit = from_middle(result.from_slit, places_);
    return result;
}

}  // namespace mimetic
