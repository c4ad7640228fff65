// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// Two rims across a slit that can touch: lips, or the lids of an eye. Indices of points.
struct Slit {
    std::vector<int> upper;
    std::vector<int> lower;
    Triangles triangles;  ///< of both surfaces; none: the rims are lines by x, as of lids
};

struct ContactOptions {
    double deepest = 0.012;   ///< m; what penetrates the other rim deeper is no contact across this slit
    double tolerance = 2e-5;  ///< m, of overlap that is tolerated
    double softness =
        1e-3;  ///< of the mean compliance, added to the diagonal: close points are nearly dependent
    double relaxation = 1.5;    ///< of projected Gauss-Seidel: 1 to below 2
    double convergence = 1e-4;  ///< of the largest force: smaller changes end the sweeps
    int max_sweeps = 300;
    int max_rounds = 6;  ///< of detecting contacts and resolving them

    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// Frictionless contact on an elastic skin, of points that can touch across slits. Forces are upward (y), for
/// an upright head: f >= 0 between the rims, above 0 only where the gap is closed. An overlap at rest is
/// allowed to remain.
class ContactSolver {
public:
    using Response = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    /// rest: C x 3; response: C x 3C, row j how the points move (xyz interleaved, m) under one upward newton
    /// at point j. Throws InvalidInput on indices out of range.
    ContactSolver(PointsIn rest, std::vector<Slit> slits, const Eigen::Ref<const Response>& response,
                  const ContactOptions& options = {});

    /// Upward forces, C, that resolve the overlaps at these displacements (C x 3); all 0 if there are none.
    Eigen::VectorXd solve(PointsIn displacements) const;

    /// Gaps of the overlaps, metres, all negative.
    Eigen::VectorXd gaps(PointsIn displacements) const;

private:
    struct Overlap {
        std::array<int, 4> points;      // a point, and three of the other rim
        std::array<double, 4> weights;  // that make the gap of heights
        double gap;
    };
    using Overlaps = std::vector<Overlap>;

    struct Surface {
        std::vector<int> upper, lower;  // points
        Triangles top, bottom;          // of the lower rim, of the upper one
    };

    void check_points(const std::vector<int>& points) const;
    Overlaps find(const Points& shape) const;
    void find_on_surface(const Surface& surface, const Points& shape, Overlaps& found) const;
    void find_on_lines(const Slit& slit, const Points& shape, Overlaps& found) const;
    Eigen::MatrixXd compliance_of(const Overlaps& overlaps) const;

    Points rest_;
    std::vector<Slit> lines_;
    std::vector<Surface> surfaces_;
    Eigen::VectorXd slack_;  // m, overlap of a point at rest
    Response response_;
    Eigen::MatrixXf compliance_;  // C x C: upward motion under upward forces
    ContactOptions options_;
};

/// Forces f >= 0 with compliance * f + gaps >= 0, f above 0 only where that is 0: projected Gauss-Seidel.
Eigen::VectorXd part_overlaps(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gaps,
                              const ContactOptions& options = {});

}  // namespace mimetic
