// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/nearest.hpp>
#include <numeric>
#include <string>

namespace mimetic {
namespace {

constexpr int kLeaf = 8;  // points that are looked through one by one

}  // namespace

NearestPoints::NearestPoints(MatrixIn cloud)
    : cloud_(cloud),
      order_(static_cast<std::size_t>(cloud.rows())),
      axis_(static_cast<std::size_t>(cloud.rows()), 0) {
    if (cloud_.size() == 0 || !cloud_.allFinite()) {
        throw InvalidInput("the points among which the nearest is looked for are none, or not finite");
    }
    std::iota(order_.begin(), order_.end(), 0);
    split(0, static_cast<int>(order_.size()));
}

void NearestPoints::split(int begin, int end) {
    if (end - begin <= kLeaf) {
        return;
    }
    Eigen::RowVectorXd low = cloud_.row(order_[static_cast<std::size_t>(begin)]), high = low;
    for (int i = begin; i < end; ++i) {
        low = low.cwiseMin(cloud_.row(order_[static_cast<std::size_t>(i)]));
        high = high.cwiseMax(cloud_.row(order_[static_cast<std::size_t>(i)]));
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) { return cloud_(a, axis) < cloud_(b, axis); });
    axis_[static_cast<std::size_t>(middle)] = static_cast<int>(axis);
    split(begin, middle);
    split(middle + 1, end);
}

void NearestPoints::offer(const double* point, int row, Best& best) const {
    double squared = 0;
    for (Eigen::Index k = 0; k < cloud_.cols(); ++k) {
        const double apart = cloud_(row, k) - point[k];
        squared += apart * apart;
    }
    if (squared < best.squared || (squared == best.squared && row < best.row)) {
        best = {squared, row};
    }
}

void NearestPoints::search(const double* point, int begin, int end, Best& best) const {
    if (end - begin <= kLeaf) {
        for (int i = begin; i < end; ++i) {
            offer(point, order_[static_cast<std::size_t>(i)], best);
        }
        return;
    }
    const int middle = begin + (end - begin) / 2;
    const int row = order_[static_cast<std::size_t>(middle)];
    const int axis = axis_[static_cast<std::size_t>(middle)];
    offer(point, row, best);
    const double beyond = point[axis] - cloud_(row, axis);
    const bool is_low = beyond < 0;
    search(point, is_low ? begin : middle + 1, is_low ? middle : end, best);
    if (beyond * beyond <= best.squared) {
        search(point, is_low ? middle + 1 : begin, is_low ? end : middle, best);
    }
}

Eigen::VectorXi NearestPoints::find(MatrixIn points) const {
    if (points.cols() != cloud_.cols()) {
        throw InvalidInput("points have " + std::to_string(points.cols()) + " coordinates, those they are " +
                           "compared with " + std::to_string(cloud_.cols()));
    }
    Eigen::VectorXi rows(points.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        Best best{std::numeric_limits<double>::infinity(), static_cast<int>(cloud_.rows())};
        search(points.row(i).data(), 0, static_cast<int>(order_.size()), best);
        if (best.row == cloud_.rows()) {
            throw InvalidInput("point " + std::to_string(i) + " is not finite: nothing is nearest to it");
        }
        rows[i] = best.row;
    }
    return rows;
}

}  // namespace mimetic
