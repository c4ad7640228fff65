// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <mimetic/muscles/attach.hpp>
#include <mimetic/shared/error.hpp>

namespace mimetic {
namespace {

constexpr std::array kJawMotions{JawMotion::jaw_open, JawMotion::jaw_side, JawMotion::jaw_thrust};

}  // namespace

PlacedMuscle place_muscle(const SkinMesh& canonical, const SkinMesh& mesh, const MuscleEntry& entry,
                          char side, const Eigen::RowVector2d& shift_mm) {
    const auto at = [&](LandmarkPlace place, char on, const Eigen::RowVector2d& shift) {
        place.x += shift[0];
        place.y += shift[1];
        return find_place(canonical, place, on);
    };
    const bool is_ring = entry.type == MuscleType::sphincter;
    const auto count = static_cast<Eigen::Index>(entry.insertion.size());
    PlacedMuscle placed;
    placed.name = entry.name;
    placed.muscle.type = entry.type;
    placed.muscle.insertion.resize(count + is_ring, 3);
    double scale = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
        const Place place = at(entry.insertion[i], side, shift_mm);
        placed.muscle.insertion.row(i) = place.position(mesh);
        scale += place.scale(mesh) / static_cast<double>(count);
    }
    if (is_ring) {
        const char other = side == 'L' ? 'R' : 'L';
        placed.muscle.insertion.row(count) = at(entry.insertion.at(0), other, shift_mm).position(mesh);
    } else {
        placed.muscle.origin = find_place(canonical, entry.origin, side).position(mesh);
    }
    placed.muscle.width = 1e-3 * entry.width * scale;
    placed.muscle.normal_share = entry.normal_share;
    placed.muscle.protrusion = entry.protrusion;
    placed.muscle.swelling = entry.swelling;
    placed.muscle.check();
    placed.anchor = entry.measured_at.anchor;
    placed.measured = find_place(canonical, entry.measured_at, side);
    placed.excursion = 1e-3 * entry.excursion * placed.measured.scale(mesh);
    return placed;
}

std::vector<PlacedMuscle> place_muscles(const SkinMesh& canonical, const SkinMesh& mesh,
                                        const std::vector<MuscleEntry>& table, Points2In shifts_mm) {
    if (shifts_mm.rows() != static_cast<Eigen::Index>(2 * table.size())) {
        throw InvalidInput("got shifts of " + std::to_string(shifts_mm.rows()) + " muscles, there are " +
                           std::to_string(2 * table.size()));
    }
    std::vector<PlacedMuscle> muscles;
    muscles.reserve(2 * table.size());
    for (std::size_t i = 0; i < 2 * table.size(); ++i) {
        muscles.push_back(place_muscle(canonical, mesh, table[i / 2], "LR"[i % 2],
                                       shifts_mm.row(static_cast<Eigen::Index>(i))));
    }
    return muscles;
}

SparseRows measured_rows(const SkinMesh& mesh, const std::vector<PlacedMuscle>& muscles) {
    std::vector<int> vertices;
    vertices.reserve(muscles.size());
    for (const PlacedMuscle& placed : muscles) {
        vertices.push_back(placed.measured.vertex);
    }
    return keep_rows(mesh.stencils(), vertices);
}

Eigen::RowVector3d motion_at(const SparseRows& measured, Eigen::Index index,
                             const Eigen::Ref<const Eigen::RowVectorXd>& response) {
    Eigen::RowVector3d motion = Eigen::RowVector3d::Zero();
    for (SparseRows::InnerIterator it(measured, index); it; ++it) {
        motion += it.value() * response.segment<3>(3 * it.col());
    }
    return motion;
}

void check_measured(const SparseRows& measured, Eigen::Index count, const AttachedSkin& skin) {
    if (measured.rows() != count || measured.cols() != skin.free().size()) {
        throw InvalidInput("measured is " + std::to_string(measured.rows()) + " x " +
                           std::to_string(measured.cols()) + ", needed is a row for each of " +
                           std::to_string(count) + " places and a column for each of " +
                           std::to_string(skin.free().size()) + " control vertices");
    }
}

void check_moves(double moved, const std::string& name, const std::string& anchor) {
    if (!(moved > 0)) {
        throw InvalidInput("the skin where " + name + " is measured, by " + anchor +
                           ", does not move: the mesh ends there, or that landmark is out of place");
    }
}

Pulled pull(const AttachedSkin& skin, const MuscleSurface& surface, const std::vector<PlacedMuscle>& muscles,
            const SparseRows& measured) {
    const auto count = static_cast<Eigen::Index>(muscles.size());
    check_measured(measured, count, skin);
    Pulled pulled{MatrixRows(count, surface.normals().size()), {}, Eigen::VectorXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        const Points forces = surface.forces(muscles[i].muscle);
        pulled.forces.row(i) = Eigen::Map<const Eigen::RowVectorXd>(forces.data(), forces.size());
    }
    pulled.responses = skin.respond(pulled.forces);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double moved = motion_at(measured, i, pulled.responses.row(i)).norm();
        check_moves(moved, muscles[i].name, muscles[i].anchor);
        pulled.strengths[i] = muscles[i].excursion / moved;
    }
    return pulled;
}

HeadOnJaw head_on_jaw(const std::shared_ptr<const SkinMesh>& mesh, const Jaw& jaw) {
    return {mesh->vertices(), jaw.influence(), mesh->neutral(), followed_vertices(mesh),
            jaw.rigid_vertices()};
}

MatrixRows jaw_under_skin(const Jaw& jaw, const HeadOnJaw& head) {
    if (head.influence.size() != head.skin.rows()) {
        throw InvalidInput("got the jaw's influence on " + std::to_string(head.influence.size()) +
                           " vertices of a skin of " + std::to_string(head.skin.rows()));
    }
    MatrixRows under(kJawMotions.size(), head.skin.size());
    for (Eigen::Index i = 0; i < under.rows(); ++i) {
        const Points moved = head.influence.asDiagonal() * jaw.motion(kJawMotions[i], head.skin);
        under.row(i) = Eigen::Map<const Eigen::RowVectorXd>(moved.data(), moved.size());
    }
    return under;
}

MatrixRows jaw_on_head(const MatrixRows& on_skin, const Jaw& jaw, const HeadOnJaw& head) {
    const auto [least, most] = std::minmax_element(head.rigid.begin(), head.rigid.end());
    if (head.moves_with.size() != head.vertices.rows() ||
        (!head.rigid.empty() && (*least < 0 || *most >= head.vertices.rows()))) {
        throw InvalidInput("the jaw moves vertices that are not among the head's " +
                           std::to_string(head.vertices.rows()));
    }
    if (on_skin.rows() != static_cast<Eigen::Index>(kJawMotions.size())) {
        throw InvalidInput("got " + std::to_string(on_skin.rows()) + " motions of the jaw, there are " +
                           std::to_string(kJawMotions.size()));
    }
    MatrixRows modes = spread(on_skin, head.moves_with);
    for (Eigen::Index i = 0; i < modes.rows(); ++i) {
        const Points moved = jaw.motion(kJawMotions[i], head.vertices(head.rigid, Eigen::all));
        for (std::size_t k = 0; k < head.rigid.size(); ++k) {
            modes.row(i).segment<3>(3 * head.rigid[k]) = moved.row(static_cast<Eigen::Index>(k));
        }
    }
    return modes;
}

MatrixRows jaw_modes(const AttachedSkin& skin, const Jaw& jaw, const HeadOnJaw& head) {
    return jaw_on_head(skin.respond(skin.foundation_forces(jaw_under_skin(jaw, head))), jaw, head);
}

MatrixRows lid_modes(const std::shared_ptr<const SkinMesh>& mesh) {
    MatrixRows modes(4, mesh->neutral().size());
    Eigen::Index row = 0;
    for (const char side : {'L', 'R'}) {
        const EyeLids lids{EyeFrame(mesh, side)};
        for (const Eigen::VectorXd& angle : {lids.upper_angle(), lids.lower_angle()}) {
            const Points mode = lids.turn(angle);
            modes.row(row++) = Eigen::Map<const Eigen::RowVectorXd>(mode.data(), mode.size());
        }
    }
    return modes;
}

}  // namespace mimetic
