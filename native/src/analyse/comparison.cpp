// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/analyse/comparison.hpp>
#include <mimetic/shared/checks.hpp>
#include <numeric>

namespace mimetic {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double share_of(double part, double whole) { return whole > 1e-18 ? part / whole : kNone; }

double gini_of(Eigen::VectorXd values) {
    std::sort(values.data(), values.data() + values.size());
    const double n = static_cast<double>(values.size()), sum = values.sum();
    double weighted = 0;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        weighted += (2 * (static_cast<double>(i) + 1) - n - 1) * values[i];
    }
    return share_of(weighted, n * sum);
}

double explained(const Eigen::VectorXd& values, const Eigen::VectorXd& fit) {
    const double whole = (values.array() - values.mean()).matrix().squaredNorm();
    return share_of(whole - (values - fit).squaredNorm(), whole);
}

/// Straight up between two rows, held, straight down between two more; by trying all of them.
Eigen::VectorXd best_ramp(const Eigen::VectorXd& course, int begin, int apex) {
    const int count = static_cast<int>(course.size());
    Eigen::VectorXd best = Eigen::VectorXd::Zero(count), ramp(count);
    double least = std::numeric_limits<double>::infinity();
    const auto try_ramp = [&](int up, int top, int leave, int end) {
        for (int i = 0; i < count; ++i) {
            const double rise = std::clamp((i - up) / std::max(1., static_cast<double>(top - up)), 0., 1.);
            const double fall =
                std::clamp((end - i) / std::max(1., static_cast<double>(end - leave)), 0., 1.);
            ramp[i] = std::min(rise, fall);
        }
        const double height = std::max(0., share_of(ramp.dot(course), ramp.squaredNorm()));
        const double error = (course - height * ramp).squaredNorm();
        if (error < least) {
            least = error;
            best = height * ramp;
        }
    };
    for (int up = std::max(0, begin - 4); up <= std::min(count - 2, begin + 6); ++up) {
        for (int top = std::max(up + 1, apex - 6); top <= std::min(count - 1, apex + 4); ++top) {
            for (int leave = top; leave < count; leave += 2) {
                for (int end = leave + 1; end <= count + 20; end += 3) {
                    try_ramp(up, top, leave, end);
                }
            }
        }
    }
    return best;
}

/// V, metres to the nearest vertex of the region; infinite without one.
Eigen::VectorXd distances_to_region(PointsIn vertices, VectorIn reach) {
    Eigen::VectorXd squares =
        Eigen::VectorXd::Constant(vertices.rows(), std::numeric_limits<double>::infinity());
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        if (reach[v] > 0) {
            squares = squares.cwiseMin((vertices.rowwise() - vertices.row(v)).rowwise().squaredNorm());
        }
    }
    return squares.cwiseSqrt();
}

}  // namespace

Eigen::VectorXd skin_areas(PointsIn vertices, QuadsIn faces, const std::vector<bool>& is_skin) {
    require(is_skin.size() == static_cast<std::size_t>(vertices.rows()),
            "is_skin must have an entry for each vertex");
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.rows());
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        if (!(faces.row(f).array() >= 0).all() || !(faces.row(f).array() < vertices.rows()).all() ||
            !std::all_of(faces.row(f).begin(), faces.row(f).end(),
                         [&](int v) { return is_skin[static_cast<std::size_t>(v)]; })) {
            continue;
        }
        for (const auto& half : kQuadHalves) {
            const Eigen::Vector3d a = vertices.row(faces(f, half[0])), b = vertices.row(faces(f, half[1])),
                                  c = vertices.row(faces(f, half[2]));
            const double third = (b - a).cross(c - a).norm() / 6;
            for (const int corner : half) {
                areas[faces(f, corner)] += third;
            }
        }
    }
    return areas;
}

Eigen::VectorXd displacement_std(MatrixIn modes, VectorIn stds) {
    require(modes.rows() == stds.size() && modes.cols() % 3 == 0,
            "displacement_std: modes and standard deviations differ in number");
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(modes.cols() / 3);
    for (Eigen::Index m = 0; m < modes.rows(); ++m) {
        const Eigen::Map<const Points> mode(modes.row(m).data(), variance.size(), 3);
        variance += stds[m] * stds[m] * mode.rowwise().squaredNorm();
    }
    return variance.cwiseSqrt();
}

SpatialComparison compare_displacements(PointsIn vertices, PointsIn seen, PointsIn unit, VectorIn areas,
                                        VectorIn stds, VectorIn reach) {
    const Eigen::Index count = seen.rows();
    require(vertices.rows() == count && unit.rows() == count && areas.size() == count &&
                stds.size() == count && reach.size() == count,
            "compare_displacements: arrays must have a row for each vertex");
    const Eigen::VectorXd apart = distances_to_region(vertices, reach);
    double product = 0, square = 0, inside = 0, outside = 0, far = 0, significant_inside = 0,
           significant_outside = 0;
    Eigen::VectorXd energy(count);
    for (Eigen::Index v = 0; v < count; ++v) {
        energy[v] = areas[v] * seen.row(v).squaredNorm();
        const double significant = seen.row(v).norm() > 2 * stds[v] ? energy[v] : 0;
        if (reach[v] > 0) {
            product += areas[v] * seen.row(v).dot(unit.row(v));
            square += areas[v] * unit.row(v).squaredNorm();
            inside += energy[v];
            significant_inside += significant;
        } else {
            outside += energy[v];
            far += apart[v] > kResolved ? energy[v] : 0;
            significant_outside += significant;
        }
    }
    SpatialComparison comparison{};
    comparison.intensity = square > 0 ? std::max(0., product / square) : 0;
    double left = 0;
    std::vector<double> moving;
    for (Eigen::Index v = 0; v < count; ++v) {
        if (reach[v] > 0) {
            left += areas[v] * (seen.row(v) - comparison.intensity * unit.row(v)).squaredNorm();
        }
        if (areas[v] > 0) {
            moving.push_back(energy[v]);
        }
    }
    comparison.inside_explained = share_of(inside - left, inside);
    comparison.outside_share = share_of(outside, inside + outside);
    comparison.outside_significant_share =
        share_of(significant_outside, significant_inside + significant_outside);
    comparison.outside_far_share = share_of(far, inside + outside);
    comparison.gini =
        gini_of(Eigen::Map<const Eigen::VectorXd>(moving.data(), static_cast<Eigen::Index>(moving.size())));
    return comparison;
}

TemporalComparison compare_courses(MatrixIn displacements, VectorIn areas, int begin, int apex) {
    require(displacements.cols() == 3 * areas.size() && displacements.rows() >= 3,
            "compare_courses: displacements must be N x 3V with N of 3 or more");
    require(begin >= 0 && apex > begin && apex < displacements.rows(),
            "compare_courses: the application lies outside the frames");
    Eigen::MatrixXd weighted = displacements;
    for (Eigen::Index v = 0; v < areas.size(); ++v) {
        weighted.middleCols(3 * v, 3) *= std::sqrt(std::max(0., areas[v]));
    }
    // N x N instead of N x 3V: frames are few
    const Eigen::MatrixXd gram = weighted * weighted.transpose();
    const Eigen::JacobiSVD<Eigen::MatrixXd> factor(gram, Eigen::ComputeThinU);
    TemporalComparison comparison{};
    comparison.rank_one_share = share_of(factor.singularValues()[0], factor.singularValues().sum());
    Eigen::VectorXd course = factor.matrixU().col(0);
    course *= course.sum() < 0 ? -1 : 1;
    const double highest = course.maxCoeff();
    comparison.course = highest > 0 ? Eigen::VectorXd(course / highest) : course;
    const int n = apex - begin + 1;
    Eigen::MatrixXd line(n, 2);
    line.col(0).setOnes();
    line.col(1) = Eigen::VectorXd::LinSpaced(n, 0, 1);
    const Eigen::VectorXd application = comparison.course.segment(begin, n);
    const Eigen::Matrix2d normal = line.transpose() * line;
    comparison.ramp_explained =
        explained(application, line * normal.inverse() * (line.transpose() * application));
    comparison.ramp = best_ramp(comparison.course, begin, apex);
    comparison.ramp_whole_explained = explained(comparison.course, comparison.ramp);
    return comparison;
}

FacesInView faces_in_view(PointsIn vertices, QuadsIn faces) {
    check_corners(faces, vertices.rows());
    std::vector<int> seen;
    std::vector<double> depth(static_cast<std::size_t>(faces.rows())), shade(depth.size());
    const Eigen::Vector3d light = Eigen::Vector3d(.35, .45, .82).normalized();
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)),
                              c = vertices.row(faces(f, 2)), d = vertices.row(faces(f, 3));
        const Eigen::Vector3d normal = (c - a).cross(d - b).normalized();
        if (normal.z() > 0) {
            const auto at = static_cast<std::size_t>(f);
            depth[at] = (a.z() + b.z() + c.z() + d.z()) / 4;
            shade[at] = std::clamp(.25 + .75 * normal.dot(light), 0., 1.);
            seen.push_back(static_cast<int>(f));
        }
    }
    std::stable_sort(seen.begin(), seen.end(), [&](int one, int other) {
        return depth[static_cast<std::size_t>(one)] < depth[static_cast<std::size_t>(other)];
    });
    FacesInView view{seen, Eigen::VectorXd(static_cast<Eigen::Index>(seen.size()))};
    for (std::size_t i = 0; i < seen.size(); ++i) {
        view.shades[static_cast<Eigen::Index>(i)] = shade[static_cast<std::size_t>(seen[i])];
    }
    return view;
}

}  // namespace mimetic
