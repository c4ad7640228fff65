// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>
#include <mimetic/contact/skin_contact.hpp>
#include <mimetic/contact/slits.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

/// Two rims of a hole in an elastic sheet in x and y, the upper one 2 mm over the lower one, metres.
class SkinContactTest : public testing::Test {
protected:
    static constexpr int kSide = 12;

    void SetUp() override {
        constexpr int row = kSide + 1;
        vertices.resize(row * row, 3);
        for (int y = 0; y < row; ++y) {
            for (int x = 0; x < row; ++x) {
                vertices.row(y * row + x) << .002 * x, .002 * y, 0;
            }
        }
        std::vector<Eigen::RowVector3i> rows;
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const int a = y * row + x;
                if (y != kSide / 2 || x < 3 || x > 8) {
                    rows.emplace_back(a, a + 1, a + row + 1);
                    rows.emplace_back(a, a + row + 1, a + row);
                }
            }
        }
        triangles.resize(rows.size(), 3);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            triangles.row(static_cast<Eigen::Index>(i)) = rows[i];
        }
        for (int x = 4; x <= 8; ++x) {
            slit.lower.push_back(kSide / 2 * row + x);
            slit.upper.push_back((kSide / 2 + 1) * row + x);
        }
        const Eigen::VectorXd one = Eigen::VectorXd::Ones(vertices.rows());
        basis.resize(vertices.rows(), vertices.rows());
        basis.setIdentity();
        model = std::make_unique<SkinModel>(
            vertices, triangles, SkinMaterials{1e5 * one, 0 * one, 1e-3 * one, 0 * one, 1e6 * one, 1e6 * one},
            basis);
        free.assign(static_cast<std::size_t>(vertices.rows()), true);
        for (int v = 0; v < vertices.rows(); ++v) {
            same.push_back(v);
        }
    }

    SkinContact make(const SparseRows& carrier = {}) const {
        const auto [points, slits] = number_slits({slit}, free);
        SparseRows stencils(static_cast<Eigen::Index>(points.size()), vertices.rows());
        for (std::size_t i = 0; i < points.size(); ++i) {
            stencils.insert(static_cast<Eigen::Index>(i), points[i]) = 1;
        }
        std::vector<int> moves_with = same;
        moves_with.push_back(slit.upper[2]);  // a lash
        moves_with.push_back(-1);             // a tooth
        return SkinContact({vertices(points, Eigen::all), stencils, slits}, {},
                           {*model, free, moves_with, same, carrier});
    }

    /// The upper rim pressed 3 mm down, with what is tied to it; of the whole head.
    Points pressed() const {
        Points displacement = Points::Zero(vertices.rows() + 2, 3);
        for (const int vertex : slit.upper) {
            displacement(vertex, 1) = -.003;
        }
        return displacement;
    }

    Points vertices;
    Triangles triangles;
    Slit slit{{}, {}, Triangles(0, 3)};
    SparseRows basis;
    std::unique_ptr<SkinModel> model;
    std::vector<bool> free;
    std::vector<int> same;
};

TEST_F(SkinContactTest, RimsThatOverlapArePartedAndOthersLeftAlone) {
    const SkinContact contact = make();
    EXPECT_TRUE(contact.relieve(0 * pressed()).isZero(0));
    EXPECT_LT(contact.gaps(pressed()).minCoeff(), -.0009);
    const Points relieved = contact.relieve(pressed());
    const Eigen::VectorXd gaps = contact.gaps(relieved);
    EXPECT_GT(gaps.size() ? gaps.minCoeff() : 0., -1e-4);
    EXPECT_TRUE(relieved.row(vertices.rows() + 1).isZero(0));
    const double lifted = relieved(slit.upper[2], 1) + .003;
    EXPECT_GT(lifted, 1e-4);
    EXPECT_NEAR(relieved(vertices.rows(), 1), lifted, 1e-7);
}

TEST_F(SkinContactTest, ASkinThatIsCarriedYieldsByItsShare) {
    SparseRows carrier(vertices.rows(), vertices.rows());
    carrier.setIdentity();
    EXPECT_TRUE(make(carrier).relieve(pressed()).isApprox(make().relieve(pressed()), 1e-9));
    // What is not carried does not yield, what is pressed against it does all of it
    const int row = kSide + 1;
    for (int v = 0; v < vertices.rows(); ++v) {
        if (v < (kSide / 2 + 1) * row) {
            carrier.row(v) *= 0;
        }
    }
    const SkinContact half = make(carrier);
    const Points relieved = half.relieve(pressed());
    EXPECT_GT(half.gaps(relieved).size() ? half.gaps(relieved).minCoeff() : 0., -1e-4);
    for (const int vertex : slit.lower) {
        EXPECT_TRUE(relieved.row(vertex).isZero(0));
    }
    EXPECT_THROW(make(SparseRows(3, vertices.rows())), InvalidInput);
}

TEST_F(SkinContactTest, AnotherFrameGivesTheSameTurned) {
    const SkinContact contact = make();
    Eigen::Matrix3d linear;
    linear << 0, -2, 0, 2, 0, 0, 0, 0, 2;
    const Points turned = contact.turned(linear).relieve(pressed() * linear.transpose());
    EXPECT_TRUE(turned.isApprox(contact.relieve(pressed()) * linear.transpose(), 1e-5));
}

TEST_F(SkinContactTest, ShapesOfATakeAddUpToItsCorrections) {
    const SkinContact contact = make();
    const Points whole = pressed();
    const Points seen = whole(contact.vertices(), Eigen::all);
    MotionPart part{MatrixRows(5, 1), MatrixRows(1, seen.size())};
    part.values << 0, 1, .8, .2, .9;
    part.modes.row(0) = Eigen::Map<const Eigen::RowVectorXd>(seen.data(), seen.size());
    const ContactShapes shapes = contact_shapes(contact, {part}, {});
    ASSERT_GT(shapes.offsets.rows(), 0);
    EXPECT_DOUBLE_EQ(shapes.values.maxCoeff(), 1);
    EXPECT_EQ(shapes.values.row(0).norm() + shapes.values.row(3).norm(), 0);
    for (const Eigen::Index i : {1, 2, 4}) {
        const auto corrected = contact.correction(part.values(i, 0) * seen);
        ASSERT_TRUE(corrected);
        const Eigen::RowVectorXd sum = shapes.values.row(i) * shapes.offsets;
        EXPECT_LT((Eigen::Map<const Points>(sum.data(), sum.size() / 3, 3) - corrected->cast<double>())
                      .cwiseAbs()
                      .maxCoeff(),
                  5.1e-5);
    }
    EXPECT_EQ(contact_shapes(contact, {part}, [](double) { return false; }).offsets.rows(), 0);
}

TEST_F(SkinContactTest, AnEyeHoldsWhatLiesOnIt) {
    EyeRest eye{Eigen::Vector3d(0, 0, -.012), {0}, Points::Zero(1, 3), Eigen::VectorXd::Ones(1), .0005};
    Points sunk(1, 3);
    sunk << 0, 0, -.002;
    EXPECT_NEAR(eye.push(sunk)(0, 2), .0015, 1e-12);
    sunk << 0, 0, .002;
    EXPECT_TRUE(eye.push(sunk).isZero(0));
}

TEST_F(SkinContactTest, LidsLieOnTheEyeUpToTheirEnd) {
    const MuscleSurface surface(vertices, triangles,
                                std::vector<bool>(static_cast<std::size_t>(triangles.rows()), true));
    const Points margin = vertices.row(0);
    const EyeRest eye = rest_on_eye(surface, margin, vertices.topRows(13), {.01, 0, -.01}, .009, 2);
    EXPECT_EQ(eye.vertices, std::vector<int>({0, 1, 2, 3, 4}));
    EXPECT_DOUBLE_EQ(eye.share[0], 1);
    EXPECT_DOUBLE_EQ(eye.share[2], 1);  // up to half the reach
    EXPECT_GT(eye.share[3], eye.share[4]);
    EXPECT_GT(eye.share[4], 0);
    EXPECT_DOUBLE_EQ(eye.sink, .0012);
}

TEST(Slits, LidsArePartedByTheLineBetweenTheCorners) {
    Points points(5, 3), corners(2, 3);
    corners << .02, 0, 0, .04, .004, 0;
    points << .02, 0, 0, .03, .006, 0, .03, -.002, 0, .035, .001, 0, .04, .004, 0;
    const Slit slit = lid_slit(points, {0, 1, 2, 3, 4}, corners, 1);
    EXPECT_EQ(slit.upper, std::vector<int>({1}));
    EXPECT_EQ(slit.lower, std::vector<int>({2, 3}));
}

}  // namespace
}  // namespace mimetic
