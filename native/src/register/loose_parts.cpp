// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mimetic/register/loose_parts.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/nearest.hpp>
#include <optional>

namespace mimetic {
namespace {

constexpr double kNearSkin = .008;    // m at the template's size: lashes, brows, beards
constexpr std::size_t kSamples = 16;  // vertices by which a part is classified
// An eyeball's middle lies this near to the template's, and its vertices so far from that, in its radii
constexpr double kEyeMiddle = .5, kEyeNearest = .6, kEyeFarthest = 1.5;
// A shell before an eye: how far its sphere's middle lies from the template's and how much larger it is, in
// the template's radii; how rough it is, in its own; cosine of how far it looks aside; how much of its longer
// side the shorter has; how far its point nearest to its middle is from there, in the shell's own reach
constexpr double kShellMiddle = .6, kShellLeast = .5, kShellMost = 1.7, kRough = .08, kForward = .5,
                 kRound = .4, kFilled = .35;
// A ball of any size before which the template's eye lies, as of a drawn figure: how rough it is, how near
// its middle its own points' mean lies, how far the front of the template's eye is from its surface, both in
// its radius; its radius in the template's; and at most so much of the distance between the eyes
constexpr double kBallRough = .12, kBallMiddle = .3, kBallFront = .4, kBallLeast = .3, kBallMost = .6;
constexpr std::size_t kMaxFollowing = 50'000;

constexpr double kTop = .13;     // m of a head, from its top, by whose width its size is guessed
constexpr double kAside = .02;   // m beside the middle where the front is looked for
constexpr double kLevel = .03;   // m above and below the tip of the nose
constexpr double kInFront = .3;  // how much depth counts beside height and breadth

/// Number of a part's samples nearest to each part of the template.
struct Votes {
    int samples = 0, jaw = 0, still = 0, left = 0, right = 0, near = 0;

    bool mostly(int count) const { return 2 * count > samples; }
};

using Parts = std::map<int, std::vector<int>>;

Parts parts_of(const Eigen::VectorXi& loose) {
    Parts parts;
    for (Eigen::Index v = 0; v < loose.size(); ++v) {
        if (loose[v] >= 0) {
            parts[loose[v]].push_back(static_cast<int>(v));
        }
    }
    return parts;
}

Votes vote(const Points& points, const Points& roots, const std::vector<TemplatePart>& like) {
    Votes votes;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const TemplatePart part = like[static_cast<std::size_t>(i)];
        ++votes.samples;
        votes.jaw += part == TemplatePart::lower_jaw;
        votes.left += part == TemplatePart::left_eye;
        votes.right += part == TemplatePart::right_eye;
        votes.near += (points.row(i) - roots.row(i)).norm() < kNearSkin;
    }
    votes.still = votes.left + votes.right +
                  static_cast<int>(std::count(like.begin(), like.end(), TemplatePart::upper_teeth));
    return votes;
}

/// The sphere of an eyeball of the template, of radius 0 where it has none.
Sphere eyeball(PointsIn laid, const std::vector<TemplatePart>& parts, TemplatePart eye) {
    std::vector<Eigen::Index> rows;
    for (std::size_t v = 0; v < parts.size(); ++v) {
        if (parts[v] == eye) {
            rows.push_back(static_cast<Eigen::Index>(v));
        }
    }
    return rows.size() < 4 ? Sphere{Eigen::Vector3d::Zero(), 0} : nearest_sphere(laid(rows, Eigen::all));
}

/// Whether a part's sampled points lie around the middle of an eyeball, as its skin does. What of the
/// template they are nearest to does not say that: socket and lids lie as near to a ball as the template's
/// own few vertices.
bool is_around(const Sphere& eye, PointsIn points) {
    if (!(eye.radius > 0) ||
        (points.colwise().mean() - eye.centre.transpose()).norm() > kEyeMiddle * eye.radius) {
        return false;
    }
    const Eigen::VectorXd distances = (points.rowwise() - eye.centre.transpose()).rowwise().norm();
    return distances.minCoeff() > kEyeNearest * eye.radius &&
           distances.maxCoeff() < kEyeFarthest * eye.radius;
}

/// Whether a part is a shell before an eyeball: a cap of a sphere about the eye's middle, with skin over its
/// own middle, as a ring of lashes has none.
bool is_shell(const Sphere& eye, PointsIn points) {
    if (!(eye.radius > 0) || points.rows() < 8) {
        return false;
    }
    const Sphere own = nearest_sphere(points);
    if (!((own.centre - eye.centre).norm() < kShellMiddle * eye.radius) ||
        own.radius < kShellLeast * eye.radius || own.radius > kShellMost * eye.radius) {
        return false;
    }
    // Convex to the front: what a scan sees of the socket is a cap of the same sphere, from within
    const Eigen::RowVector3d outwards = points.colwise().mean() - own.centre.transpose();
    if (!(outwards.z() > kForward * outwards.norm())) {
        return false;
    }
    const Points spread = points.rowwise() - points.colwise().mean();
    const Eigen::VectorXd distances = (points.rowwise() - own.centre.transpose()).rowwise().norm();
    const double roughness =
        std::sqrt((distances.array() - own.radius).square().mean()) / std::max(own.radius, 1e-12);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(Eigen::Matrix3d(spread.transpose() * spread));
    const Eigen::Vector3d sides = axes.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
    const Eigen::RowVector3d pole = own.centre.transpose() + own.radius * outwards.normalized();
    const Eigen::VectorXd from_pole = (points.rowwise() - pole).rowwise().norm();
    return roughness < kRough && sides[1] > kRound * sides[2] &&
           from_pole.minCoeff() < kFilled * from_pole.maxCoeff();
}

/// The sphere of a part that is a whole ball in the place of an eye.
std::optional<Sphere> ball_of(const Sphere& eye, const Sphere& other_eye, PointsIn points) {
    if (!(eye.radius > 0) || points.rows() < 8) {
        return std::nullopt;
    }
    const Sphere own = nearest_sphere(points);
    const Eigen::VectorXd distances = (points.rowwise() - own.centre.transpose()).rowwise().norm();
    const double roughness = std::sqrt((distances.array() - own.radius).square().mean());
    const Eigen::Vector3d middle = points.colwise().mean().transpose(),
                          to_front = eye.centre + eye.radius * Eigen::Vector3d::UnitZ() - own.centre;
    const bool is_ball =
        roughness < kBallRough * own.radius && (middle - own.centre).norm() < kBallMiddle * own.radius;
    const bool is_there = std::abs(to_front.norm() - own.radius) < kBallFront * own.radius &&
                          to_front.z() > kForward * to_front.norm();
    const bool is_as_large = own.radius > kBallLeast * eye.radius &&
                             own.radius < kBallMost * (eye.centre - other_eye.centre).norm();
    return is_ball && is_there && is_as_large ? std::optional(own) : std::nullopt;
}

}  // namespace

LooseParts sort_loose_parts(const ForeignSkin& skin, PointsIn laid, const std::vector<TemplatePart>& parts) {
    if (parts.size() != static_cast<std::size_t>(laid.rows())) {
        throw InvalidInput("each vertex of the template needs its part");
    }
    const auto count = static_cast<std::size_t>(skin.loose.size());
    LooseParts sorted;
    sorted.on_jaw.assign(count, false);
    sorted.on_eye = {sorted.on_jaw, sorted.on_jaw};
    const Parts loose = parts_of(skin.loose);
    if (loose.empty()) {
        return sorted;
    }
    const NearestPoints on_template(laid), on_skin(skin.vertices);
    const std::array<Sphere, 2> eyes{eyeball(laid, parts, TemplatePart::left_eye),
                                     eyeball(laid, parts, TemplatePart::right_eye)};
    for (const auto& [label, vertices] : loose) {
        std::vector<int> sample;
        const std::size_t step = (vertices.size() + kSamples - 1) / kSamples;
        for (std::size_t i = 0; i < vertices.size(); i += step) {
            sample.push_back(vertices[i]);
        }
        const Points points = skin.user_vertices(sample, Eigen::all);
        std::vector<TemplatePart> like;
        for (const int vertex : on_template.find(points)) {
            like.push_back(parts[static_cast<std::size_t>(vertex)]);
        }
        const Votes votes = vote(points, skin.vertices(on_skin.find(points), Eigen::all), like);
        const Points whole = skin.user_vertices(vertices, Eigen::all);
        const auto is_of = [&](int votes_of_eye, std::size_t side) {
            const std::optional<Sphere> ball = ball_of(eyes[side], eyes[1 - side], whole);
            std::optional<Sphere>& largest = sorted.balls[side];
            if (ball && (!largest || ball->radius > largest->radius)) {
                largest = ball;
            }
            return ball || votes.mostly(votes_of_eye) || is_around(eyes[side], points) ||
                   is_shell(eyes[side], whole);
        };
        const std::array<bool, 2> is_eye{is_of(votes.left, 0), is_of(votes.right, 1)};
        const bool is_still = votes.mostly(votes.still) || is_eye[0] || is_eye[1];
        const bool is_on_jaw = votes.mostly(votes.jaw) && !is_still;
        for (const int vertex : vertices) {
            const auto v = static_cast<std::size_t>(vertex);
            sorted.on_jaw[v] = is_on_jaw;
            sorted.on_eye[0][v] = is_eye[0];
            sorted.on_eye[1][v] = is_eye[1];
        }
        if (votes.mostly(votes.near) && !is_on_jaw && !is_still) {
            sorted.following.insert(sorted.following.end(), vertices.begin(), vertices.end());
        }
    }
    std::sort(sorted.following.begin(), sorted.following.end());
    if (sorted.following.size() > kMaxFollowing) {
        sorted.num_left = static_cast<int>(sorted.following.size());
        sorted.following.clear();
    } else if (!sorted.following.empty()) {
        sorted.roots = on_skin.find(skin.user_vertices(sorted.following, Eigen::all));
    }
    return sorted;
}

namespace {

/// Least and largest x of what is less than kTop under the top.
Eigen::Vector2d breadth_at_top(PointsIn points) {
    const double top = points.col(2).maxCoeff();
    Eigen::Vector2d range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        if (points(v, 2) > top - kTop) {
            range = {std::min(range[0], points(v, 0)), std::max(range[1], points(v, 0))};
        }
    }
    return range;
}

}  // namespace

Points guess_places(PointsIn points, PointsIn usual_skin, PointsIn usual_places, int nose) {
    if (points.rows() == 0 || !points.allFinite()) {
        throw InvalidInput("the mesh has no vertices, or one that is not finite");
    }
    require(usual_skin.rows() > 0, "the usual head has no skin");
    check_vertices({nose}, usual_places.rows(), "usual head's places");
    const Eigen::Vector2d own = breadth_at_top(points), usual = breadth_at_top(usual_skin);
    const double scale = std::clamp((own[1] - own[0]) / (usual[1] - usual[0]), .5, 2.);
    Eigen::RowVector3d shift(own.mean(), 0, points.col(2).maxCoeff() - scale * usual_skin.col(2).maxCoeff());
    const Eigen::RowVector3d tip = scale * usual_places.row(nose);
    double front = std::numeric_limits<double>::infinity();
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        if (std::abs(points(v, 0) - shift[0]) < kAside * scale &&
            std::abs(points(v, 2) - shift[2] - tip[2]) < kLevel * scale) {
            front = std::min(front, points(v, 1));
        }
    }
    shift[1] = (std::isfinite(front) ? front : points.col(1).minCoeff()) - tip[1];
    Points guessed(usual_places.rows(), 3);
    for (Eigen::Index i = 0; i < usual_places.rows(); ++i) {
        const Eigen::RowVector3d place = scale * usual_places.row(i) + shift;
        const Eigen::RowVector3d counts(1, kInFront, 1);
        Eigen::Index nearest = 0;
        ((points.rowwise() - place) * counts.asDiagonal()).rowwise().squaredNorm().minCoeff(&nearest);
        guessed.row(i) = points.row(nearest);
    }
    return guessed;
}

}  // namespace mimetic
