// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/shared/error.hpp>
#include <numeric>

#include "carried.hpp"
#include "interpolate.hpp"

namespace mimetic {
namespace {

constexpr double kLowerRaise = 0.003;
constexpr double kLowerTarsus = 0.005;    // the lower lid moves rigidly up to this distance from its margin
constexpr double kLowerReach = 0.020;     // and fades to the lower rim of the orbit, without a fold
constexpr double kCornerSharpness = 4.0;  // how soon a lid's motion ends where the other lid is nearer
constexpr double kFar = 0.03;             // m; limit of geodesic distances

std::vector<int> without(const std::vector<int>& vertices, const std::vector<int>& others) {
    std::vector<int> kept;
    for (const int v : vertices) {
        if (std::find(others.begin(), others.end(), v) == others.end()) {
            kept.push_back(v);
        }
    }
    return kept;
}

}  // namespace

EyeFrame::EyeFrame(std::shared_ptr<const SkinMesh> the_mesh, char the_side,
                   const std::optional<Eigen::Vector3d>& own_centre)
    : mesh(std::move(the_mesh)), side(the_side) {
    if (side != 'L' && side != 'R') {
        throw InvalidInput(std::string("an eye's side is '") + side + "', needed is L or R");
    }
    const std::string end = std::string(".") + side;
    const TemplateSkin& shared = mesh->shared();
    const Eigen::RowVector3d usual = mesh->head().eye_centers.row(side == 'L' ? 0 : 1);
    centre = own_centre ? own_centre->transpose() : carried(*mesh, usual, shared.part_vertices("eye" + end));
    const Eigen::RowVector3d inner = mesh->landmark_place("eye_inner" + end);
    const Eigen::RowVector3d outer = mesh->landmark_place("eye_outer" + end);
    axis = side == 'L' ? outer - inner : inner - outer;
    axis[2] = 0;  // corners lie at different depths; lids close straight down
    axis.normalize();
    const Points& neutral = mesh->neutral();
    for (const int v : shared.vertices_between("skin", "eye_socket")) {
        if (side == 'L' ? neutral(v, 0) > 0 : neutral(v, 0) < 0) {
            margin.push_back(v);
        }
    }
    if (margin.empty()) {
        throw InvalidInput(std::string("the head has no lids on side ") + side);
    }
    lashes = shared.part_vertices("lashes" + end);
    for (const int lash : lashes) {
        const auto nearer = [&](int a, int b) {
            return (neutral.row(a) - neutral.row(lash)).norm() < (neutral.row(b) - neutral.row(lash)).norm();
        };
        roots.push_back(*std::min_element(margin.begin(), margin.end(), nearer));
    }
}

EyeFrame::Polar EyeFrame::polar(PointsIn points) const {
    const Eigen::RowVector3d up = Eigen::RowVector3d(0, 0, 1).cross(axis);
    Polar polar{Eigen::VectorXd(points.rows()), Eigen::VectorXd(points.rows()),
                Eigen::VectorXd(points.rows())};
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::RowVector3d arm = points.row(i) - centre;
        const double height = arm.dot(up);
        polar.along[i] = arm.dot(axis);
        polar.elevation[i] = std::atan2(height, arm[2]);
        polar.radius[i] = std::hypot(height, arm[2]);
    }
    return polar;
}

EyeLids::EyeLids(EyeFrame frame) : frame_(std::move(frame)) {
    const std::vector<int>& margin = frame_.margin;
    const EyeFrame::Polar at = frame_.polar(frame_.mesh->neutral()(margin, Eigen::all));
    Eigen::Index inner = 0;
    Eigen::Index outer = 0;
    at.along.minCoeff(&inner);
    at.along.maxCoeff(&outer);
    const Eigen::Vector2d ends(at.along[inner], at.along[outer]);
    const Eigen::Vector2d heights(at.elevation[inner], at.elevation[outer]);
    for (Eigen::Index i = 0; i < at.along.size(); ++i) {
        const double chord = interpolate(at.along[i], ends, heights);
        const bool is_corner = i == inner || i == outer;
        if (at.elevation[i] >= chord || is_corner) {
            upper_.push_back(margin[i]);
        }
        if (at.elevation[i] < chord || is_corner) {
            lower_.push_back(margin[i]);
        }
    }
}

Eigen::VectorXd EyeLids::opening(VectorIn along) const {
    Eigen::VectorXd angle = Eigen::VectorXd::Zero(along.size());
    for (const auto& [margin, sign] : {std::pair(&upper_, 1.0), std::pair(&lower_, -1.0)}) {
        const EyeFrame::Polar at = frame_.polar(frame_.mesh->neutral()(*margin, Eigen::all));
        std::vector<Eigen::Index> order(margin->size());
        std::iota(order.begin(), order.end(), 0);
        std::sort(order.begin(), order.end(),
                  [&](Eigen::Index a, Eigen::Index b) { return at.along[a] < at.along[b]; });
        const Eigen::VectorXd xs = at.along(order);
        const Eigen::VectorXd ys = at.elevation(order);
        for (Eigen::Index i = 0; i < along.size(); ++i) {
            angle[i] += sign * interpolate(along[i], xs, ys);
        }
    }
    return angle.cwiseMax(0);
}

Eigen::VectorXd EyeLids::raise(VectorIn along) const {
    const EyeFrame::Polar at = frame_.polar(frame_.mesh->neutral()(lower_, Eigen::all));
    const double widest =
        opening(Eigen::VectorXd::LinSpaced(50, at.along.minCoeff(), at.along.maxCoeff())).maxCoeff();
    const double angle = -kLowerRaise * frame_.mesh->size() / at.radius.maxCoeff();
    return angle * (opening(along) / widest).cwiseSqrt();
}

Eigen::VectorXd EyeLids::upper_angle() const {
    const SkinMesh& mesh = *frame_.mesh;
    const Eigen::VectorXd along = frame_.polar(mesh.neutral().topRows(mesh.head().num_skin_vertices)).along;
    return share(upper_, lower_, {0, kReach}).cwiseProduct(opening(along));
}

Eigen::VectorXd EyeLids::lower_angle() const {
    const SkinMesh& mesh = *frame_.mesh;
    const Eigen::VectorXd along = frame_.polar(mesh.neutral().topRows(mesh.head().num_skin_vertices)).along;
    return share(lower_, upper_, {kLowerTarsus, kLowerReach}).cwiseProduct(raise(along));
}

Eigen::VectorXd EyeLids::share(const std::vector<int>& margin, const std::vector<int>& other,
                               const Fade& fade) const {
    const SkinMesh& mesh = *frame_.mesh;
    const double far = kFar * mesh.size();
    const Eigen::VectorXd own = mesh.whole_surface().distances(mesh.places(margin), far);
    const Eigen::VectorXd across =
        mesh.whole_surface().distances(mesh.places(without(other, margin)), far);  // without the corners
    const Flags behind = mesh.shared().in_region("eye_socket");
    Eigen::VectorXd share(behind.size());
    for (Eigen::Index v = 0; v < share.size(); ++v) {
        const double full = mesh.size() * (behind[v] ? 0 : fade.full);
        const double end = mesh.size() * (behind[v] ? kReach / 2 : fade.end);
        const double to_own = std::min(own[v], far);
        const double to_other = std::min(across[v], far);
        // Round the corner lies the other lid, which stays.
        const double nearer = kCornerSharpness * (to_other - to_own) / (to_other + to_own);
        share[v] = smooth_step((end - to_own) / (end - full)) * smooth_step(nearer);
    }
    return share;
}

Points EyeLids::turn(VectorIn angle) const {
    const Points& neutral = frame_.mesh->neutral();
    if (angle.size() != frame_.mesh->head().num_skin_vertices) {
        throw InvalidInput("got " + std::to_string(angle.size()) + " angles, needed is one for each of " +
                           std::to_string(frame_.mesh->head().num_skin_vertices) + " skin vertices");
    }
    const auto skin = neutral.topRows(angle.size());
    Points mode = Points::Zero(neutral.rows(), 3);
    mode.topRows(angle.size()) = rotate(skin, frame_.centre, frame_.axis, angle) - skin;
    const Points hair = neutral(frame_.lashes, Eigen::all);
    mode(frame_.lashes, Eigen::all) =
        rotate(hair, frame_.centre, frame_.axis, Eigen::VectorXd(angle(frame_.roots))) - hair;
    return mode;
}

Eigen::VectorXi followed_vertices(const std::shared_ptr<const SkinMesh>& mesh) {
    const Eigen::Index count = mesh->head().num_skin_vertices;
    Eigen::VectorXi moves_with = Eigen::VectorXi::Constant(mesh->neutral().rows(), -1);
    std::iota(moves_with.begin(), moves_with.begin() + count, 0);
    for (const char side : {'L', 'R'}) {
        const EyeFrame frame(mesh, side);
        for (std::size_t i = 0; i < frame.lashes.size(); ++i) {
            moves_with[frame.lashes[i]] = frame.roots[i];
        }
    }
    return moves_with;
}

MatrixRows spread(MatrixIn skin_modes, const Eigen::VectorXi& moves_with) {
    if (moves_with.size() > 0 && 3 * Eigen::Index{moves_with.maxCoeff()} >= skin_modes.cols()) {
        throw InvalidInput("vertex " + std::to_string(moves_with.maxCoeff()) +
                           " of the skin is followed, it has " + std::to_string(skin_modes.cols() / 3));
    }
    MatrixRows modes = MatrixRows::Zero(skin_modes.rows(), 3 * moves_with.size());
    for (Eigen::Index v = 0; v < moves_with.size(); ++v) {
        if (moves_with[v] >= 0) {
            modes.middleCols<3>(3 * v) = skin_modes.middleCols<3>(3 * Eigen::Index{moves_with[v]});
        }
    }
    return modes;
}

}  // namespace mimetic
