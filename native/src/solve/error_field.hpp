// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/solve/model_error.hpp>
#include <vector>

namespace mimetic {

/// The heights of the field of ModelError: bumps around nodes over the skin, of unit variance at every point.
template <typename Scalar>
class ErrorField {
public:
    using Point = Eigen::Matrix<Scalar, 3, 1>;
    struct NearNode {
        int node;
        Scalar height;
    };
    static constexpr double kCorrelationLength = .012;  ///< metres over the skin
    static constexpr double kNodeSpacing = .02;         ///< metres

    /// Its nodes are some of these points (head frame, metres), no two closer than kNodeSpacing. reach: of
    /// the exponent; nodes beyond add nothing. The tracker, which evaluates every sample in every frame,
    /// truncates earlier, for speed.
    template <typename Range>
    explicit ErrorField(const Range& points, Scalar reach = std::numeric_limits<Scalar>::infinity())
        : reach_(reach) {
        for (const Point& point : points) {
            const bool is_apart = std::all_of(nodes_.begin(), nodes_.end(), [&](const Point& node) {
                return (node - point).norm() > Scalar(kNodeSpacing);
            });
            if (is_apart) {
                nodes_.push_back(point);
            }
        }
    }

    std::size_t num_nodes() const { return nodes_.size(); }

    /// The nodes that reach a point, with the field's heights there.
    std::vector<NearNode> near(const Point& point) const {
        std::vector<NearNode> found;
        constexpr auto kLength = static_cast<Scalar>(kCorrelationLength);
        Scalar energy = Scalar(1e-9);
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            const Scalar distance = (nodes_[node] - point).squaredNorm() / (2 * kLength * kLength);
            if (distance < reach_) {
                found.push_back({static_cast<int>(node), std::exp(-distance)});
                energy += found.back().height * found.back().height;
            }
        }
        for (NearNode& entry : found) {
            entry.height /= std::sqrt(energy);
        }
        return found;
    }

private:
    Scalar reach_;
    std::vector<Point> nodes_;
};

}  // namespace mimetic
