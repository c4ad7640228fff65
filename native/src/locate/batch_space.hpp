// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/eigenspace.hpp>

namespace mimetic::locate {

using Windows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Mean 0 and variance 1 of every row, in place; rows without contrast become 0.
void normalize_rows(Windows& windows);

/// Distances of many normalised windows from one space, in single precision.
class BatchSpace {
public:
    struct Distances {
        Eigen::ArrayXf within;          ///< as SpaceDistance
        Eigen::ArrayXf from;            ///< as SpaceDistance, over rho
        Eigen::ArrayXf log_likelihood;  ///< as SpaceDistance, less N / 2 log(2 pi)
    };

    explicit BatchSpace(const Eigenspace& space);
    Distances of(const Windows& normalized) const;

private:
    Eigen::RowVectorXf mean_;
    Eigen::MatrixXf basis_;         ///< N x M
    Eigen::RowVectorXf precision_;  ///< M
    float rho_ = 1;
    float normalizer_ = 0;
};

}  // namespace mimetic::locate
