// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <Eigen/SVD>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/similarity.hpp>

namespace mimetic {

Points Similarity::apply(PointsIn points) const {
    Points result(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {  // one by one: equal points stay equal
        const Eigen::Vector3d point = points.row(i);
        result.row(i) = (scale * (rotation * point) + shift).transpose();
    }
    return result;
}

Points Similarity::turn(PointsIn displacements) const { return scale * displacements * rotation.transpose(); }

Similarity Similarity::inverse() const {
    const Eigen::Matrix3d back = rotation.transpose();
    return {1 / scale, back, -(back * shift) / scale, is_mirror};
}

Similarity fit_similarity(PointsIn source, PointsIn target) {
    if (source.rows() < 3 || source.rows() != target.rows()) {
        throw InvalidInput(
            "a similarity needs three points and more, as many of the target as of the source");
    }
    const Eigen::RowVector3d from = source.colwise().mean(), to = target.colwise().mean();
    const Points a = source.rowwise() - from, b = target.rowwise() - to;
    const Eigen::Matrix3d correlation = b.transpose() * a;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
    const bool is_mirror = turn.determinant() < 0;
    const Eigen::Vector3d side(1, 1, is_mirror ? -1 : 1);
    Similarity fitted;
    fitted.is_mirror = is_mirror;
    fitted.rotation = svd.matrixU() * side.asDiagonal() * svd.matrixV().transpose();
    fitted.scale = svd.singularValues().dot(side) / a.squaredNorm();
    fitted.shift = to.transpose() - fitted.scale * fitted.rotation * from.transpose();
    return fitted;
}

bool is_rigid(const Eigen::Matrix4d& pose, double rounding) {
    const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>();
    const double off = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    return off <= rounding && rotation.determinant() > 0 && pose.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
}

}  // namespace mimetic
