// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/analyse/comparison.hpp>
#include <mimetic/shared/checks.hpp>
#include <numeric>

namespace mimetic {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double share_of(double part, double whole) { return whole > 1e-18 ? part / whole : kNone; }

/// Twice the area between the diagonal and the Lorenz curve of a value of which every part of the skin has as
/// much as its area.
double gini_of(const Eigen::VectorXd& values, VectorIn areas) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Eigen::Index one, Eigen::Index other) { return values[one] < values[other]; });
    double area = 0, sum = 0, under = 0;
    for (const Eigen::Index i : order) {
        const double part = areas[i] * values[i];
        under += areas[i] * (2 * sum + part);
        area += areas[i];
        sum += part;
    }
    return share_of(area * sum - under, area * sum);
}

double explained(const Eigen::VectorXd& values, const Eigen::VectorXd& fit) {
    const double whole = (values.array() - values.mean()).matrix().squaredNorm();
    return share_of(whole - (values - fit).squaredNorm(), whole);
}

/// Rows at which a ramp leaves 0, is up, goes down again and is back.
using RampTimes = std::array<double, 4>;

constexpr double kBeyondEnds = 20;      // rows by which a ramp may begin before the course, or end after it
constexpr double kLeastStep = 1. / 32;  // rows

bool is_ramp(const RampTimes& times, Eigen::Index count) {
    const auto [up, top, leave, end] = times;
    return -kBeyondEnds <= up && up + 1 <= top && top <= leave && leave + 1 <= end &&
           end <= static_cast<double>(count) + kBeyondEnds;
}

/// The ramp at the height that suits the course best.
Eigen::VectorXd ramp_of(const Eigen::VectorXd& course, const RampTimes& times) {
    const auto [up, top, leave, end] = times;
    Eigen::VectorXd ramp(course.size());
    for (Eigen::Index i = 0; i < ramp.size(); ++i) {
        const double row = static_cast<double>(i);
        ramp[i] = std::min(std::clamp((row - up) / (top - up), 0., 1.),
                           std::clamp((end - row) / (end - leave), 0., 1.));
    }
    const double square = ramp.squaredNorm();
    return square > 0 ? Eigen::VectorXd(std::max(0., ramp.dot(course) / square) * ramp) : ramp;
}

/// The best of ramps some rows apart, whose application is about rows begin to apex.
RampTimes rough_ramp(const Eigen::VectorXd& course, int begin, int apex) {
    const int count = static_cast<int>(course.size());
    RampTimes best{};
    double least = std::numeric_limits<double>::infinity();
    for (int up = std::max(0, begin - 4); up <= std::min(count - 2, begin + 6); ++up) {
        for (int top = std::max(up + 1, apex - 6); top <= std::min(count - 1, apex + 4); ++top) {
            for (int leave = top; leave < count; leave += 2) {
                for (int end = leave + 1; end <= count + 20; end += 3) {
                    const RampTimes times{double(up), double(top), double(leave), double(end)};
                    const double error = (course - ramp_of(course, times)).squaredNorm();
                    if (error < least) {
                        least = error;
                        best = times;
                    }
                }
            }
        }
    }
    return best;
}

/// Straight up between two times, held, straight down between two more: the best of a search in steps of
/// rows, its times then moved one by one, by ever smaller parts of a row, while that helps.
Eigen::VectorXd best_ramp(const Eigen::VectorXd& course, int begin, int apex) {
    RampTimes times = rough_ramp(course, begin, apex);
    double least = (course - ramp_of(course, times)).squaredNorm();
    for (double step = 1; step >= kLeastStep; step /= 2) {
        for (bool is_better = true; is_better;) {
            is_better = false;
            for (std::size_t i = 0; i < 2 * times.size(); ++i) {
                RampTimes moved = times;
                moved[i / 2] += i % 2 == 0 ? step : -step;
                if (!is_ramp(moved, course.size())) {
                    continue;
                }
                const double error = (course - ramp_of(course, moved)).squaredNorm();
                if (error < least) {
                    least = error;
                    times = moved;
                    is_better = true;
                }
            }
        }
    }
    return ramp_of(course, times);
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
    for (Eigen::Index v = 0; v < count; ++v) {
        if (reach[v] > 0) {
            left += areas[v] * (seen.row(v) - comparison.intensity * unit.row(v)).squaredNorm();
        }
    }
    comparison.inside_explained = share_of(inside - left, inside);
    comparison.outside_share = share_of(outside, inside + outside);
    comparison.outside_significant_share =
        share_of(significant_outside, significant_inside + significant_outside);
    comparison.outside_far_share = share_of(far, inside + outside);
    comparison.gini = gini_of(seen.rowwise().squaredNorm(), areas);
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
