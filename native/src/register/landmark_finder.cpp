// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/register/landmark_finder.hpp>
#include <mimetic/register/registration.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/shared/scale.hpp>

#include "face_details.hpp"
#include "shared/robust.hpp"
#include "view_camera.hpp"

namespace mimetic {
namespace {

constexpr std::size_t kAround = 40;  // points of the network that carry a landmark
constexpr double kPresent = .5;      // of a view that counts
constexpr double kSameError = .02;   // interpupillary distances, what all views have wrong alike
constexpr double kUnlike = .12;      // of how far a landmark lies from where the template has it
constexpr double kUnseenCorner =
    .05;  // the same, of a corner where the mesh has no opening, as eyes that skin covers
constexpr double kSeenCorner = .012;   // the same, of a corner that the mesh's own opening gives
constexpr double kMoved = .25;         // of how far the laid template moves a landmark
constexpr double kLeastShare = .05;    // of a face that was laid on a mesh, in its doubt
constexpr double kDisagreement = .15;  // interpupillary distances, median over the landmarks
constexpr double kNoseShare = .4;      // of the template's height, of what is a nose
constexpr double kSearchShare = .3;    // of the time, for the direction
constexpr double kCutShare = .1;       // of the template's faces: a shorter neck is no mask
constexpr int kMeanRounds = 20;        // of the geometric median
constexpr double kLeastGap = 1e-4;     // m, in its weights

/// The rows of `points` that are finite in both, the nearest to a place first.
std::vector<Eigen::Index> nearest_rows(const Points& points, const Points& others,
                                       const Eigen::RowVector3d& place) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        if (points.row(i).allFinite() && others.row(i).allFinite()) {
            rows.push_back(i);
        }
    }
    const auto end = rows.begin() + static_cast<std::ptrdiff_t>(std::min(kAround, rows.size()));
    std::partial_sort(rows.begin(), end, rows.end(), [&](Eigen::Index a, Eigen::Index b) {
        return (points.row(a) - place).squaredNorm() < (points.row(b) - place).squaredNorm();
    });
    rows.erase(end, rows.end());
    return rows;
}

/// A landmark carried along with the points of one view round it.
Eigen::RowVector3d carried(const Eigen::RowVector3d& landmark, const Points& from, const Points& to) {
    const std::vector<Eigen::Index> rows = nearest_rows(from, to, landmark);
    Points sources(0, 3), targets(0, 3);
    std::vector<Eigen::Index> kept;
    for (const Eigen::Index row : rows) {  // two pixels may show one place
        if (std::none_of(kept.begin(), kept.end(), [&](Eigen::Index other) {
                return (from.row(other) - from.row(row)).norm() < 1e-6;
            })) {
            kept.push_back(row);
        }
    }
    if (kept.size() < 8) {
        return Eigen::RowVector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    sources = from(kept, Eigen::all);
    targets = to(kept, Eigen::all);
    return warp_points(landmark, sources, targets);
}

/// The point with the least sum of distances [Weiszfeld 1937], and the median distance from it.
std::pair<Eigen::RowVector3d, double> middle_of(const std::vector<Eigen::RowVector3d>& places) {
    Eigen::RowVector3d middle;
    for (Eigen::Index k = 0; k < 3; ++k) {
        std::vector<double> values;
        values.reserve(places.size());
        for (const Eigen::RowVector3d& place : places) {
            values.push_back(place[k]);
        }
        middle[k] = median(values);
    }
    for (int round = 0; round < kMeanRounds; ++round) {
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        double weights = 0;
        for (const Eigen::RowVector3d& place : places) {
            const double weight = 1 / std::max((place - middle).norm(), kLeastGap);
            sum += weight * place;
            weights += weight;
        }
        middle = sum / weights;
    }
    std::vector<double> gaps;
    gaps.reserve(places.size());
    for (const Eigen::RowVector3d& place : places) {
        gaps.push_back((place - middle).norm());
    }
    return {middle, median(gaps)};
}

/// The template as the networks are to be shown it beside a head, if that is a mask or has no eyeballs: what
/// is round a face, and in its eyes, moves where they see it, and so it is missing in both.
std::optional<ShownHead> like(const ShownHead& head, const ShownHead& whole) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < head.mesh.triangles.size(); ++i) {
        box.extend(head.mesh.vertices.row(head.mesh.triangles.data()[i]).transpose());
    }
    const bool has_eyes = std::find(head.is_eye.begin(), head.is_eye.end(), true) != head.is_eye.end();
    std::vector<Eigen::Index> kept;
    Eigen::Index num_outside = 0;
    for (Eigen::Index t = 0; t < whole.mesh.triangles.rows(); ++t) {
        const Points corners = whole.mesh.vertices(whole.mesh.triangles.row(t), Eigen::all);
        if (!box.contains(corners.colwise().mean().transpose())) {
            ++num_outside;
        } else if (has_eyes || !whole.is_eye[static_cast<std::size_t>(t)]) {
            kept.push_back(t);
        }
    }
    const auto share = static_cast<double>(num_outside) / static_cast<double>(whole.mesh.triangles.rows());
    if (has_eyes && share < kCutShare) {
        return {};
    }
    ShownHead cut;
    cut.mesh = {whole.mesh.vertices, whole.mesh.normals, whole.mesh.triangles(kept, Eigen::all),
                whole.mesh.colours(kept, Eigen::all)};
    for (const Eigen::Index t : kept) {
        cut.part.push_back(whole.part[static_cast<std::size_t>(t)]);
        cut.is_eye.push_back(whole.is_eye[static_cast<std::size_t>(t)]);
    }
    return cut;
}

/// The landmarks' places, each of which must have a name and be a vertex.
Points places_of(PointsIn vertices, const std::vector<std::string>& names, const std::vector<int>& rows) {
    require(names.size() == rows.size(), "there must be a name for each landmark");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i] < 0 || rows[i] >= vertices.rows()) {
            throw InvalidInput("landmark " + names[i] + " is vertex " + std::to_string(rows[i]) +
                               ", which the template does not have");
        }
    }
    return vertices(rows, Eigen::all);
}

}  // namespace

LandmarkFinder::LandmarkFinder(PointsIn vertices, TrianglesIn triangles, std::vector<std::string> names,
                               std::vector<int> landmarks, DeformableTemplate people,
                               const FeatureNetworks& networks)
    : names_(std::move(names)),
      rows_(std::move(landmarks)),
      landmarks_(places_of(vertices, names_, rows_)),
      people_(std::move(people)),
      networks_(networks),
      directions_(view_directions()),
      template_(shown_head(vertices, triangles)),
      views_(face_views(template_, networks_, directions_, {})) {
    for (const FaceView& view : views_) {
        require(view.presence > kPresent, "the networks see no face in the template");
        crops_.push_back(view.crop);
    }
}

std::optional<PlacedLandmarks> LandmarkFinder::place(PointsIn vertices, TrianglesIn triangles,
                                                     const Progress& progress) const {
    const ShownHead mesh = shown_head(vertices, triangles);
    const auto part = [&](double begin, double end) -> Progress {
        return progress ? Progress([=](double share) { return progress(begin + (end - begin) * share); })
                        : Progress{};
    };
    const std::optional<Facing> facing = find_facing(mesh, networks_, views_.front(), part(0, kSearchShare));
    if (!facing) {
        return std::nullopt;
    }
    const ShownHead head = mesh.aligned(facing->mesh_from_template.inverse());
    const std::optional<ShownHead> cut = like(head, template_);
    const double half = cut ? (kSearchShare + 1) / 2 : 1;
    const std::vector<FaceView> views =
        face_views(head, networks_, directions_, crops_, part(kSearchShare, half));
    const std::vector<FaceView> usual =
        cut ? face_views(*cut, networks_, directions_, crops_, part(half, 1)) : views_;
    if (std::min(views.size(), usual.size()) < directions_.size()) {
        return std::nullopt;
    }
    PlacedLandmarks placed{landmarks_, Eigen::VectorXd(landmarks_.rows()), facing->mesh_from_template};
    for (Eigen::Index i = 0; i < landmarks_.rows(); ++i) {
        std::vector<Eigen::RowVector3d> places;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const Eigen::RowVector3d place =
                std::min(views[v].presence, usual[v].presence) > kPresent
                    ? carried(landmarks_.row(i), usual[v].places, views[v].places)
                    : Eigen::RowVector3d::Constant(std::numeric_limits<double>::quiet_NaN());
            if (place.allFinite()) {
                places.push_back(place);
            }
        }
        if (places.empty()) {
            return std::nullopt;
        }
        const auto [middle, spread] = middle_of(places);
        placed.places.row(i) = middle;
        placed.sigma[i] = std::hypot(spread / kPupilDistance, kSameError);
    }
    if (median({placed.sigma.begin(), placed.sigma.end()}) > kDisagreement) {
        return std::nullopt;  // each view shows another face: there is none
    }
    follow_details(head, views.front().places, placed);
    // What is unlike the template, its networks' faces and ours alike, is placed less surely
    const Eigen::VectorXd unlike = (placed.places - landmarks_).rowwise().norm() / kPupilDistance;
    placed.sigma = (placed.sigma.array().square() + (kUnlike * unlike.array()).square()).sqrt();
    lay_template(head, views.front().places, placed);
    placed.places = placed.mesh_from_template.apply(on_shown_surface(head, placed.places));
    return placed;
}

void LandmarkFinder::lay_template(const ShownHead& head, const Points& face, PlacedLandmarks& placed) const {
    const int skin = skin_part(head, face);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < head.mesh.triangles.rows(); ++t) {
        if (head.part[static_cast<std::size_t>(t)] == skin) {
            kept.push_back(t);
        }
    }
    const LaidVertices laid =
        people_.lay(rows_, placed.places, placed.sigma * kPupilDistance, head.mesh.vertices,
                    head.mesh.normals, head.mesh.triangles(kept, Eigen::all));
    // Where little of the face lies on the mesh, little of what its surface seemed to tell can be believed
    const double share = std::max(1 - laid.misfit, kLeastShare);
    const Eigen::ArrayXd moved = (laid.places - placed.places).rowwise().norm();
    placed.sigma =
        ((laid.sigma.array() / share).square() + (kMoved * moved).square()).sqrt() / kPupilDistance;
    placed.places = laid.places;
}

void LandmarkFinder::follow_details(const ShownHead& head, const Points& face,
                                    PlacedLandmarks& placed) const {
    const auto row_of = [&](const std::string& name) {
        const auto at = std::find(names_.begin(), names_.end(), name);
        return at == names_.end() ? Eigen::Index{-1} : static_cast<Eigen::Index>(at - names_.begin());
    };
    const int own_skin = skin_part(head, face), usual_skin = skin_part(template_, views_.front().places);
    for (const std::string side : {".L", ".R"}) {
        const Eigen::Index inner = row_of("eye_inner" + side), outer = row_of("eye_outer" + side);
        if (inner < 0 || outer < 0) {
            continue;
        }
        const auto usual = eye_opening(template_, usual_skin, landmarks_.row(inner), landmarks_.row(outer));
        const auto own = eye_opening(head, own_skin, placed.places.row(inner), placed.places.row(outer));
        if (usual && !own) {
            for (const Eigen::Index row : {inner, outer}) {
                placed.sigma[row] = std::hypot(placed.sigma[row], kUnseenCorner);
            }
        }
        if (!usual || !own) {
            continue;
        }
        for (const Eigen::Index row : {inner, outer}) {
            const Eigen::Vector2d share = usual->share_of(landmarks_.row(row).head<2>().transpose());
            const Eigen::Vector2d place = own->place_of(share);
            const double depth = placed.places(row, 2);
            const auto on_skin = skin_at(head, own_skin, place);
            placed.places.row(row) << place.x(), place.y(), on_skin ? on_skin->z() : depth;
            placed.sigma[row] = std::min(placed.sigma[row], kSeenCorner);
        }
    }
    if (const Eigen::Index tip = row_of("nose_tip"); tip >= 0) {
        const auto usual = foremost(template_, landmarks_.row(tip)),
                   own = foremost(head, placed.places.row(tip));
        if (usual && own && own->height > kNoseShare * usual->height) {
            placed.places.row(tip) = own->place.transpose() + landmarks_.row(tip) - usual->place.transpose();
            placed.sigma[tip] = std::min(placed.sigma[tip], kSeenCorner);
        }
    }
}

}  // namespace mimetic
