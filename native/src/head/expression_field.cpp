// SPDX-License-Identifier: GPL-3.0-or-later
#include "expression_field.hpp"

#include <algorithm>
#include <cmath>
#include <mimetic/error.hpp>
#include <string>

namespace mimetic {
namespace {

constexpr double kCell = 5e-3;   // metres
constexpr double kReach = 6e-3;  // metres over which neighbouring skin moves alike

}  // namespace

double expression_precision(double angle, const Expression& now) {
    constexpr double kRest = .3, kNear = .22;  // standard deviations; rad
    const double turned = 1 + std::pow(angle / kNear, 4);
    return turned * turned / (kRest * kRest + now.squaredNorm() / kNumExpressions);
}

ExpressionField::ExpressionField(PointsIn vertices, MatrixIn movements) {
    const Eigen::Vector2d least = vertices.leftCols<2>().colwise().minCoeff();
    const Eigen::Vector2d most = vertices.leftCols<2>().colwise().maxCoeff();
    origin_ = least;
    cols_ = static_cast<int>((most.x() - least.x()) / kCell) + 2;
    rows_ = static_cast<int>((most.y() - least.y()) / kCell) + 2;
    cells_.assign(static_cast<std::size_t>(cols_ * rows_), Movements::Zero());
    std::vector<double> shares(cells_.size(), 0);
    constexpr int kCells = 3;
    for (Eigen::Index i = 0; i < vertices.rows(); ++i) {
        if (vertices(i, 2) <= 0) {
            continue;
        }
        Movements moved = Movements::Zero();
        for (int axis = 0; axis < 3; ++axis) {
            moved.row(axis).head(movements.cols()) = movements.row(3 * i + axis);
        }
        const Eigen::Vector2d place = (vertices.row(i).head<2>().transpose() - origin_) / kCell;
        const int x = static_cast<int>(std::lround(place.x())), y = static_cast<int>(std::lround(place.y()));
        for (int row = std::max(0, y - kCells); row <= std::min(rows_ - 1, y + kCells); ++row) {
            for (int col = std::max(0, x - kCells); col <= std::min(cols_ - 1, x + kCells); ++col) {
                const double apart = kCell * (Eigen::Vector2d(col, row) - place).norm() / kReach;
                const double share = std::exp(-.5 * apart * apart);
                cells_[static_cast<std::size_t>(row * cols_ + col)] += share * moved;
                shares[static_cast<std::size_t>(row * cols_ + col)] += share;
            }
        }
    }
    for (std::size_t k = 0; k < cells_.size(); ++k) {
        cells_[k] /= std::max(1e-3, shares[k]);
    }
}

const ExpressionField::Movements* ExpressionField::at(const Eigen::Vector3d& point_in_head) const {
    const Eigen::Vector2d place = (point_in_head.head<2>() - origin_) / kCell;
    const int x = static_cast<int>(std::lround(place.x())), y = static_cast<int>(std::lround(place.y()));
    if (point_in_head.z() <= 0 || x < 0 || y < 0 || x >= cols_ || y >= rows_) {
        return nullptr;
    }
    return &cells_[static_cast<std::size_t>(y * cols_ + x)];
}

std::shared_ptr<const ExpressionField> make_expression_field(PointsIn vertices, MatrixIn movements) {
    if (movements.rows() != 3 * vertices.rows() || movements.cols() > kNumExpressions ||
        !movements.allFinite() || !vertices.allFinite() || vertices.rows() == 0) {
        throw InvalidInput("movements are " + std::to_string(movements.rows()) + " x " +
                           std::to_string(movements.cols()) + ", needed are finite ones, " +
                           std::to_string(3 * vertices.rows()) + " x at most " +
                           std::to_string(kNumExpressions));
    }
    return std::make_shared<const ExpressionField>(vertices, movements);
}

}  // namespace mimetic
