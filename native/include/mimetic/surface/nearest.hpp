// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Nearest points of a cloud, by a k-d tree [Bentley 1975]. Of points that are equally near, the first.
class NearestPoints {
public:
    /// cloud: a point a row, of any number of coordinates. Throws InvalidInput if it is empty or not finite.
    explicit NearestPoints(MatrixIn cloud);

    /// Row of the cloud that is nearest to each row of `points`, which have as many coordinates.
    Eigen::VectorXi find(MatrixIn points) const;

private:
    struct Best {
        double squared;
        int row;
    };

    void split(int begin, int end);
    void search(const double* point, int begin, int end, Best& best) const;
    void offer(const double* point, int row, Best& best) const;

    MatrixRows cloud_;
    std::vector<int> order_;  // rows; the middle of a range splits it
    std::vector<int> axis_;   // along which the row there splits its range
};

}  // namespace mimetic
