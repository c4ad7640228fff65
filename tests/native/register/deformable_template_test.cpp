// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/register/deformable_template.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/similarity.hpp>
#include <random>

namespace mimetic {
namespace {

constexpr int kSide = 41;        // vertices of a side of the template
constexpr double kStep = .003;   // m between them
constexpr double kDoubt = .003;  // m, of the targets

/// A bowl with a ridge and a bump, seen from z; `count` vertices a side.
struct Sheet {
    Points vertices;
    Triangles triangles;

    explicit Sheet(int count) : vertices(count * count, 3), triangles(2 * (count - 1) * (count - 1), 3) {
        const double step = kStep * (kSide - 1) / (count - 1), half = kStep * (kSide - 1) / 2;
        for (int i = 0; i < count; ++i) {
            for (int j = 0; j < count; ++j) {
                const double x = step * j - half, y = step * i - half;
                const double ridge = .02 * std::exp(-x * x / 2e-4) * std::exp(-y * y / 1e-3);
                const double bump = .01 * std::exp(-((x - .03) * (x - .03) + (y - .03) * (y - .03)) / 2e-4);
                vertices.row(i * count + j) << x, y, ridge + bump - 6 * (x * x + y * y);
            }
        }
        Eigen::Index t = 0;
        for (int i = 0; i + 1 < count; ++i) {
            for (int j = 0; j + 1 < count; ++j) {
                const int a = i * count + j, b = a + 1, c = a + count, d = c + 1;
                triangles.row(t++) << a, b, d;
                triangles.row(t++) << a, d, c;
            }
        }
    }
};

/// How a place of the sheet moves by the modes: a wider one, and one whose ridge is to a side.
Points moved(const Points& places, const Eigen::Vector2d& values) {
    Points result = places;
    result.col(0) += values[0] * places.col(0) +
                     values[1] * .006 * (-places.col(0).array().square() / 4e-4).exp().matrix();
    return result;
}

DeformableTemplate people(const Sheet& sheet) {
    MatrixRows modes(2, sheet.vertices.size());
    for (Eigen::Index k = 0; k < 2; ++k) {
        const Points by = moved(sheet.vertices, Eigen::Vector2d::Unit(k)) - sheet.vertices;
        modes.row(k) = by.reshaped<Eigen::RowMajor>().transpose();
    }
    return {sheet.vertices, sheet.triangles, modes, Eigen::Vector2d(.1, 1),
            std::vector<bool>(static_cast<std::size_t>(sheet.vertices.rows()), true)};
}

/// A person, meshed anew, and landmarks seen a few millimetres away from where they are.
struct Seen {
    std::vector<int> rows{3 * kSide + 20, 20 * kSide + 8, 20 * kSide + 32, 33 * kSide + 12, 30 * kSide + 30};
    Points truth, targets, vertices, normals;
    Triangles triangles;

    Seen(const Eigen::Vector2d& values, double bend) {
        const Sheet own(kSide), other(67);
        const Similarity placed{
            1.03, Eigen::AngleAxisd(.05, Eigen::Vector3d(1, 2, 1).normalized()).toRotationMatrix(),
            Eigen::Vector3d(.002, -.003, .004)};
        const auto as_seen = [&](const Points& places) {
            Points person = moved(places, values);
            person.col(1) += bend * (places.col(0).array() * 60).sin().matrix();
            return placed.apply(person);
        };
        truth = as_seen(own.vertices(rows, Eigen::all));
        vertices = as_seen(other.vertices);
        triangles = other.triangles;
        normals = vertex_normals(vertices, triangles);
        std::mt19937 random(3);
        std::normal_distribution<double> error(0, kDoubt / std::sqrt(3.));
        targets = truth.unaryExpr([&](double value) { return value + error(random); });
    }

    LaidVertices laid(const DeformableTemplate& by) const {
        return by.lay(rows, targets, Eigen::VectorXd::Constant(targets.rows(), kDoubt), vertices, normals,
                      triangles);
    }
    Eigen::VectorXd errors(const Points& places) const { return (places - truth).rowwise().norm(); }
};

TEST(DeformableTemplate, TellsLandmarksByTheSurfaceBetweenThem) {
    const Sheet sheet(kSide);
    const Seen person({.12, .8}, 0);
    const LaidVertices laid = person.laid(people(sheet));
    EXPECT_LT(person.errors(laid.places).mean(), .4 * person.errors(person.targets).mean());
    EXPECT_TRUE((person.errors(laid.places).array() < 2 * laid.sigma.array()).all());
    EXPECT_LT(laid.sigma.maxCoeff(), 1.5 * kDoubt);  // 2.4 by the targets alone, whose weight is half
    EXPECT_LT(laid.misfit, .08);
}

TEST(DeformableTemplate, FollowsWhatNoModeMakes) {
    const Sheet sheet(kSide);
    const Seen bent({.12, .8}, .003);
    const LaidVertices laid = bent.laid(people(sheet));
    EXPECT_LT(bent.errors(laid.places).mean(), bent.errors(bent.targets).mean());
    EXPECT_LT(laid.misfit, .1);
}

TEST(DeformableTemplate, SaysWhenItDoesNotLieOnTheMesh) {
    const Sheet sheet(kSide);
    Seen other({0, 0}, 0);
    other.vertices.col(2) +=
        .004 * (other.vertices.leftCols<2>().rowwise().norm().array() * 900).sin().matrix();
    other.normals = vertex_normals(other.vertices, other.triangles);
    EXPECT_GT(other.laid(people(sheet)).misfit, .3);
}

TEST(DeformableTemplate, RefusesWhatDoesNotFitTogether) {
    const Sheet sheet(kSide);
    const DeformableTemplate good = people(sheet);
    Seen person({0, 0}, 0);
    person.rows[0] = kSide * kSide;
    EXPECT_THROW(person.laid(good), InvalidInput);
    person = Seen({0, 0}, 0);
    person.targets(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(person.laid(good), InvalidInput);
    const MatrixRows modes = MatrixRows::Zero(1, 3);
    EXPECT_THROW(DeformableTemplate(sheet.vertices, sheet.triangles, modes, Eigen::VectorXd::Ones(1),
                                    std::vector<bool>(static_cast<std::size_t>(sheet.vertices.rows()), true)),
                 InvalidInput);
    EXPECT_THROW(
        DeformableTemplate(sheet.vertices, sheet.triangles, MatrixRows::Zero(1, sheet.vertices.size()),
                           Eigen::VectorXd::Ones(1),
                           std::vector<bool>(static_cast<std::size_t>(sheet.vertices.rows()), false)),
        InvalidInput);
}

}  // namespace
}  // namespace mimetic
