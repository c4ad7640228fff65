// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <mimetic/fit/face_shape.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <string>

namespace mimetic {

namespace {

/// Columns x, y and z of some vertices.
MatrixRows at_vertices(MatrixIn deformations, const std::vector<int>& vertices) {
    check_vertices(vertices, deformations.cols() / 3);
    std::vector<int> columns;
    for (const int vertex : vertices) {
        columns.insert(columns.end(), {3 * vertex, 3 * vertex + 1, 3 * vertex + 2});
    }
    return deformations(Eigen::all, columns);
}

}  // namespace

PrincipalShapes principal_shapes(MatrixIn deformations, const std::vector<int>& seen, int most) {
    require(deformations.rows() > 0 && !seen.empty() && most >= 0,
            "principal shapes need deformations, vertices that are seen, and a number of shapes");
    const MatrixRows on_seen = at_vertices(deformations, seen);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(on_seen.rows(), on_seen.rows());
    gram.selfadjointView<Eigen::Lower>().rankUpdate(on_seen);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
    const Eigen::Index count = std::min<Eigen::Index>(most, gram.rows());
    PrincipalShapes shapes{eigen.eigenvectors().rightCols(count).rowwise().reverse(),
                           eigen.eigenvalues().tail(count).reverse()};
    for (auto column : shapes.shares.colwise()) {
        Eigen::Index largest = 0;
        column.cwiseAbs().maxCoeff(&largest);
        if (column[largest] < 0) {
            column *= -1;
        }
    }
    return shapes;
}

MatrixRows paired_pulls(PointsIn skin, const std::vector<int>& places, const std::vector<bool>& on_face,
                        double radius, int parity) {
    if (static_cast<Eigen::Index>(on_face.size()) != skin.rows()) {
        throw InvalidInput("on_face must say of every vertex whether it is");
    }
    const auto spread_round = [&](const Eigen::RowVector3d& middle) {
        Eigen::VectorXd near = (-(skin.rowwise() - middle).rowwise().squaredNorm() / (2 * radius * radius))
                                   .array()
                                   .exp()
                                   .matrix();
        for (Eigen::Index v = 0; v < near.size(); ++v) {
            near[v] *= on_face[static_cast<std::size_t>(v)];
        }
        return Eigen::VectorXd(near / near.sum());
    };
    std::vector<Eigen::VectorXd> pulls;
    for (const int place : places) {
        if (place < 0 || place >= skin.rows()) {
            throw InvalidInput("place " + std::to_string(place) + " is no vertex of the skin");
        }
        const Eigen::RowVector3d middle = skin.row(place);
        const Eigen::VectorXd own = spread_round(middle);
        const Eigen::VectorXd opposite = spread_round(middle.cwiseProduct(Eigen::RowVector3d(-1, 1, 1)));
        for (int axis = 0; axis < 3; ++axis) {
            const double sign = axis == 0 ? -parity : parity;
            if (sign < 0 && std::abs(middle.x()) < 1e-6) {
                continue;  // a force that cancels itself
            }
            Points pull = Points::Zero(skin.rows(), 3);
            pull.col(axis) = (own + sign * opposite) / 2;
            pulls.emplace_back(Eigen::Map<Eigen::VectorXd>(pull.data(), pull.size()));
        }
    }
    MatrixRows all(static_cast<Eigen::Index>(pulls.size()), skin.size());
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
        all.row(i) = pulls[static_cast<std::size_t>(i)];
    }
    return all;
}

MatrixRows elastic_modes(MatrixIn pulls, MatrixIn responses, const std::vector<int>& face, double spread,
                         double least_variance) {
    if (pulls.rows() != responses.rows() || pulls.cols() != responses.cols() || pulls.rows() == 0 ||
        face.empty()) {
        throw InvalidInput("every pull must have its response, and the face vertices");
    }
    const Eigen::MatrixXd compliance = pulls * responses.transpose();
    const Eigen::LLT<Eigen::MatrixXd> root((compliance + compliance.transpose()) / 2);
    if (root.info() != Eigen::Success) {
        throw InvalidInput("the responses are none of an elastic skin: pulls gain energy");
    }
    const MatrixRows likely = root.matrixL().solve(responses);  // of unit energy each
    const PrincipalShapes shapes = principal_shapes(likely, face, static_cast<int>(likely.rows()));
    Eigen::Index count = 0;
    while (count < shapes.variances.size() &&
           shapes.variances[count] > least_variance * shapes.variances[0]) {
        ++count;
    }
    MatrixRows modes = shapes.shares.leftCols(count).transpose() * likely;
    const double square_sum = at_vertices(modes, face).squaredNorm();
    return modes * (spread / std::sqrt(square_sum / static_cast<double>(3 * face.size())));
}

MatrixRows bumps(PointsIn skin, const std::vector<int>& places, double radius) {
    if (!(radius > 0) || places.empty()) {
        throw InvalidInput("bumps must have places, and a radius above 0");
    }
    MatrixRows heights(static_cast<Eigen::Index>(places.size()), skin.rows());
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i] < 0 || places[i] >= skin.rows()) {
            throw InvalidInput("place " + std::to_string(places[i]) + " is no vertex of the skin");
        }
        const Eigen::RowVector3d middle = skin.row(places[i]);
        heights.row(static_cast<Eigen::Index>(i)) =
            (-(skin.rowwise() - middle).rowwise().squaredNorm() / (2 * radius * radius))
                .array()
                .exp()
                .matrix()
                .transpose();
    }
    return heights / heights.colwise().norm().maxCoeff();
}

MatrixRows sliding_on_eyeball(MatrixIn modes, PointsIn skin, const std::vector<int>& margin,
                              const Eigen::Vector3d& centre, double reach, double steepest) {
    if (modes.cols() != 3 * skin.rows() || margin.empty() || !(reach > 0) || !(steepest > 0)) {
        throw InvalidInput(
            "modes must be of this skin, with a margin, a reach and a steepest cosine above 0");
    }
    for (const int m : margin) {
        if (m < 0 || m >= skin.rows()) {
            throw InvalidInput("margin " + std::to_string(m) + " is no vertex of the skin");
        }
    }
    const Points at_margin = skin(margin, Eigen::all);
    MatrixRows sliding = modes;
    for (Eigen::Index v = 0; v < skin.rows(); ++v) {
        const double square = (at_margin.rowwise() - skin.row(v)).rowwise().squaredNorm().minCoeff();
        const double share = std::exp(-square / (2 * reach * reach));
        const Eigen::Vector3d arm = skin.row(v).transpose() - centre;
        const Eigen::Vector2d back = arm.head<2>() / std::max(arm.z(), steepest * arm.norm());
        for (Eigen::Index i = 0; i < modes.rows(); ++i) {
            auto moved = sliding.row(i).segment<3>(3 * v);
            moved.z() -= share * (moved.head<2>().dot(back) + moved.z());
        }
    }
    return sliding;
}

Eigen::VectorXd nearest_coefficients(MatrixIn matrix, VectorIn values) {
    require(values.size() == matrix.rows(), "there must be a value a row");
    if (matrix.size() == 0) {
        return Eigen::VectorXd::Zero(matrix.cols());
    }
    Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
    svd.setThreshold(1e-12);
    return svd.solve(values);
}

}  // namespace mimetic
