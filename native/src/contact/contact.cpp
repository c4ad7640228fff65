// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/contact/contact.hpp>
#include <mimetic/raster/rays.hpp>
#include <mimetic/shared/error.hpp>
#include <string>
#include <utility>

namespace mimetic {
namespace {

constexpr double kShortest = 1e-9;  // m, of a piece of a line

void check_field(bool fits, const char* name, double value, const char* allowed) {
    if (!fits) {
        throw InvalidInput(std::string(name) + " is " + std::to_string(value) + ", allowed are " + allowed);
    }
}

Eigen::VectorXd gaps_of(const auto& overlaps) {
    Eigen::VectorXd gaps(static_cast<Eigen::Index>(overlaps.size()));
    for (std::size_t k = 0; k < overlaps.size(); ++k) {
        gaps[static_cast<Eigen::Index>(k)] = overlaps[k].gap;
    }
    return gaps;
}

}  // namespace

void ContactOptions::check() const {
    check_field(deepest > 0, "deepest", deepest, "lengths above 0");
    check_field(tolerance > 0, "tolerance", tolerance, "lengths above 0");
    check_field(softness > 0, "softness", softness, "numbers above 0");
    check_field(relaxation > 0 && relaxation < 2, "relaxation", relaxation, "0 to 2");
    check_field(convergence > 0, "convergence", convergence, "numbers above 0");
    check_field(max_sweeps > 0, "max_sweeps", max_sweeps, "1 and more");
    check_field(max_rounds > 0, "max_rounds", max_rounds, "1 and more");
}

ContactSolver::ContactSolver(PointsIn rest, std::vector<Slit> slits,
                             const Eigen::Ref<const Response>& response, const ContactOptions& options)
    : rest_(rest), slack_(Eigen::VectorXd::Zero(rest.rows())), response_(response), options_(options) {
    options_.check();
    const Eigen::Index count = rest_.rows();
    if (response_.rows() != count || response_.cols() != 3 * count) {
        throw InvalidInput("response is " + std::to_string(response_.rows()) + " x " +
                           std::to_string(response_.cols()) + ", needed are " + std::to_string(count) +
                           " x " + std::to_string(3 * count));
    }
    compliance_.resize(count, count);
    for (Eigen::Index j = 0; j < count; ++j) {
        for (Eigen::Index i = 0; i < count; ++i) {
            compliance_(i, j) = response_(j, 3 * i + 1);
        }
    }
    for (Slit& slit : slits) {
        check_points(slit.upper);
        check_points(slit.lower);
        if (slit.triangles.rows() == 0) {
            lines_.push_back(std::move(slit));
            continue;
        }
        check_points({slit.triangles.data(), slit.triangles.data() + slit.triangles.size()});
        std::vector<bool> is_upper(static_cast<std::size_t>(count));
        for (const int point : slit.upper) {
            is_upper[static_cast<std::size_t>(point)] = true;
        }
        const auto of_rim = [&](bool upper) {
            std::vector<Eigen::Index> rows;
            for (Eigen::Index t = 0; t < slit.triangles.rows(); ++t) {
                if (is_upper[static_cast<std::size_t>(slit.triangles(t, 0))] == upper) {
                    rows.push_back(t);
                }
            }
            return Triangles(slit.triangles(rows, Eigen::all));
        };
        Surface surface{slit.upper, slit.lower, of_rim(false), of_rim(true)};
        surfaces_.push_back(std::move(surface));
    }
    Eigen::VectorXd slack = slack_;
    for (const Overlap& overlap : find(rest_)) {
        slack[overlap.points[0]] = -overlap.gap;
    }
    slack_ = slack;
}

void ContactSolver::check_points(const std::vector<int>& points) const {
    for (const int point : points) {
        if (point < 0 || point >= rest_.rows()) {
            throw InvalidInput("a slit names point " + std::to_string(point) + " of " +
                               std::to_string(rest_.rows()));
        }
    }
}

Eigen::VectorXd ContactSolver::solve(PointsIn displacements) const {
    Points shape = rest_ + displacements;
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(rest_.rows());
    for (int round = 0; round < options_.max_rounds; ++round) {
        const Overlaps overlaps = find(shape);
        const Eigen::VectorXd gaps = gaps_of(overlaps);
        if (overlaps.empty() || gaps.minCoeff() > -options_.tolerance) {
            break;
        }
        const Eigen::VectorXd pushes = part_overlaps(compliance_of(overlaps), gaps, options_);
        Eigen::VectorXd added = Eigen::VectorXd::Zero(rest_.rows());
        for (std::size_t k = 0; k < overlaps.size(); ++k) {
            for (std::size_t i = 0; i < 4; ++i) {
                added[overlaps[k].points[i]] += overlaps[k].weights[i] * pushes[static_cast<Eigen::Index>(k)];
            }
        }
        for (Eigen::Index j = 0; j < added.size(); ++j) {
            if (added[j] != 0) {
                Eigen::Map<Eigen::RowVectorXd>(shape.data(), shape.size()) +=
                    added[j] * response_.row(j).cast<double>();
            }
        }
        forces += added;
    }
    return forces;
}

Eigen::VectorXd ContactSolver::gaps(PointsIn displacements) const {
    return gaps_of(find(rest_ + displacements));
}

ContactSolver::Overlaps ContactSolver::find(const Points& shape) const {
    Overlaps found;
    for (const Surface& surface : surfaces_) {
        find_on_surface(surface, shape, found);
    }
    for (const Slit& slit : lines_) {
        find_on_lines(slit, shape, found);
    }
    return found;
}

void ContactSolver::find_on_surface(const Surface& surface, const Points& shape, Overlaps& found) const {
    const auto find_over = [&](const std::vector<int>& own, const Triangles& triangles, double sign) {
        const RayCaster caster(shape, triangles, sign > 0 ? RayCaster::Facing::up : RayCaster::Facing::down);
        for (const int point : own) {
            const RayHit hit = caster.at({shape(point, 0), shape(point, 2)});
            if (hit.triangle < 0) {
                continue;
            }
            const auto corners = triangles.row(hit.triangle);
            Overlap overlap{{point, corners[0], corners[1], corners[2]},
                            {sign, -sign * hit.weights[0], -sign * hit.weights[1], -sign * hit.weights[2]},
                            0};
            for (std::size_t i = 0; i < 4; ++i) {
                overlap.gap += overlap.weights[i] * shape(overlap.points[i], 1);
            }
            overlap.gap += slack_[point];
            if (overlap.gap < 0 && overlap.gap > -options_.deepest) {
                found.push_back(overlap);
            }
        }
    };
    find_over(surface.upper, surface.top, 1);
    find_over(surface.lower, surface.bottom, -1);
}

void ContactSolver::find_on_lines(const Slit& slit, const Points& shape, Overlaps& found) const {
    if (slit.lower.size() < 2) {
        return;
    }
    std::vector<int> lower = slit.lower;
    std::sort(lower.begin(), lower.end(), [&](int a, int b) { return shape(a, 0) < shape(b, 0); });
    for (const int point : slit.upper) {
        const auto place = std::lower_bound(lower.begin() + 1, lower.end() - 1, shape(point, 0),
                                            [&](int a, double x) { return shape(a, 0) < x; });
        const int start = *(place - 1);
        const int end = *place;
        const double length = std::max(shape(end, 0) - shape(start, 0), kShortest);
        const double share = std::clamp((shape(point, 0) - shape(start, 0)) / length, 0.0, 1.0);
        const double height = (1 - share) * shape(start, 1) + share * shape(end, 1);
        const double gap = shape(point, 1) - height + slack_[point];
        if (gap < 0) {
            found.push_back({{point, start, end, end}, {1, share - 1, -share, 0}, gap});
        }
    }
}

Eigen::MatrixXd ContactSolver::compliance_of(const Overlaps& overlaps) const {
    const auto count = static_cast<Eigen::Index>(overlaps.size());
    Eigen::MatrixXd compliance(count, count);
    Eigen::VectorXf motion(rest_.rows());
    for (Eigen::Index l = 0; l < count; ++l) {
        const Overlap& pushed = overlaps[static_cast<std::size_t>(l)];
        motion.setZero();
        for (std::size_t i = 0; i < 4; ++i) {
            motion += static_cast<float>(pushed.weights[i]) * compliance_.col(pushed.points[i]);
        }
        for (Eigen::Index k = 0; k < count; ++k) {
            const Overlap& moved = overlaps[static_cast<std::size_t>(k)];
            double sum = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                sum += moved.weights[i] * static_cast<double>(motion[moved.points[i]]);
            }
            compliance(k, l) = sum;
        }
    }
    return compliance;
}

Eigen::VectorXd part_overlaps(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gaps,
                              const ContactOptions& options) {
    const Eigen::Index count = gaps.size();
    if (compliance.rows() != count || compliance.cols() != count) {
        throw InvalidInput("the compliance is " + std::to_string(compliance.rows()) + " x " +
                           std::to_string(compliance.cols()) + " for " + std::to_string(count) + " gaps");
    }
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(count);
    if (count == 0) {
        return forces;
    }
    const double softness = options.softness * compliance.diagonal().mean();
    Eigen::VectorXd now = gaps;  // compliance * forces + gaps
    for (int sweep = 0; sweep < options.max_sweeps; ++sweep) {
        double change = 0;
        for (Eigen::Index i = 0; i < count; ++i) {
            const double step =
                -options.relaxation * (now[i] + softness * forces[i]) / (compliance(i, i) + softness);
            const double next = std::max(0.0, forces[i] + step);
            const double added = next - forces[i];
            if (added != 0) {
                now += added * compliance.col(i);
                forces[i] = next;
                change = std::max(change, std::abs(added));
            }
        }
        if (change <= options.convergence * forces.maxCoeff()) {
            break;
        }
    }
    return forces;
}

}  // namespace mimetic
