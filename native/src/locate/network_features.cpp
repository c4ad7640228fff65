// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/locate/network_features.hpp>
#include <mimetic/shared/error.hpp>
#include <span>
#include <string>

namespace mimetic {
namespace {

// Standard deviations in interpupillary distances, from faces marked by hand (docs/measured/real-faces.md).
// A lid's error is mostly the person's own bias, common along it: each station has less weight.
constexpr double kLid = 0.02;
constexpr double kEyeCorner = 0.03, kMouthCorner = 0.01;
/// Of lips' edges midway and at the corners. There the head's lips, thicker than most, meet at another slope:
/// what lies between pulls the corners inwards instead of bringing the edges nearer.
struct LipNoise {
    double midway = 0, at_corner = 0;
};
constexpr LipNoise kOuterLip{0.0073, 0.022}, kInnerLip{0.006, 0.018};
/// The networks see the lower lip's red end lower than a hand marks it, midway by this: with it heads fitted
/// to photographs of 23 people have no such error on the mean (evaluation/real/stills.csv).
constexpr double kLowerEdge = 0.012;
/// Of lines and corners for what moves by itself: a line's error is common to some of its stations.
constexpr double kLocalLid = 0.012, kLocalOuterLip = 0.0073, kLocalInnerLip = 0.006, kLocalEyeCorner = 0.01;
/// The networks, and the head fitted to them, have the outer corner of an eye nearer to the nose and higher
/// than a hand marks it, by these: the means of both eyes in single_face and cap12_edit.
constexpr double kOuterCornerIn = 0.026, kOuterCornerUp = 0.017;
/// An eyeball turns while somebody looks about: by some twenty degrees the iris wanders by this.
constexpr double kGaze = 0.08;
constexpr double kLeastSigma = 0.25;  // pixels: no finer than the picture
constexpr double kLeastPresence = 0.5;
constexpr double kElsewhere = 0.3;  // interpupillary distances between an iris and the pupil of a landmark

constexpr const char* kLocal[] = {"pupil.", "eye_", "mouth_corner."};  // beginnings of features' names
constexpr const char* kOfTheMesh = "lip_upper_inner";                  // a curve that nothing else sees

// Of the mesh
constexpr int kMouthCorners[] = {291, 61}, kOuterCorners[] = {263, 33}, kInnerCorners[] = {362, 133};

/// A line without its ends, where it meets the next one and its direction is undefined.
FeatureCurve curve_of(const std::string& name, const Points2& places, std::span<const int> line,
                      double sigma_px) {
    const auto count = static_cast<Eigen::Index>(line.size()) - 2;
    FeatureCurve curve{name, Points2(count, 2), Points2(count, 2),
                       Eigen::VectorXd::Constant(count, sigma_px)};
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        curve.points.row(i) = places.row(line[at + 1]);
        const Eigen::RowVector2d along = places.row(line[at + 2]) - places.row(line[at]);
        const double length = along.norm();
        if (length > 0) {
            curve.normals.row(i) << -along.y() / length, along.x() / length;
        } else {
            curve.normals.row(i) << 0, 1;
        }
    }
    return curve;
}

/// The line of a lip's edge; places from corner to corner. drop: interpupillary distances by which it is
/// seen too low midway.
FeatureCurve lip_edge(const std::string& name, const Points2& places, std::span<const int> line,
                      const LipNoise& noise, double pupils, double drop = 0) {
    FeatureCurve curve = curve_of(name, places, line, 0);
    const Eigen::RowVector2d first = places.row(line.front()), last = places.row(line.back());
    const double width = std::max((last - first).norm(), kLeastSigma);
    const Eigen::RowVector2d along = (last - first) / width, middle = (first + last) / 2;
    const Eigen::RowVector2d down(-along.y(), along.x());
    for (Eigen::Index i = 0; i < curve.points.rows(); ++i) {
        const double aside = std::min(1., 2 * std::abs((curve.points.row(i) - middle).dot(along)) / width);
        const double midway = 1 - aside * aside;
        curve.points.row(i) -= midway * drop * pupils * down;
        curve.sigma_px(i) =
            std::hypot((midway * noise.midway + (1 - midway) * noise.at_corner) * pupils, kLeastSigma);
    }
    return curve;
}

const Feature& pupil_of(const FaceFeatures& face, const std::string& name) {
    const Feature* pupil = face.find(name);
    if (pupil == nullptr) throw InvalidInput("the face has no feature " + name);
    return *pupil;
}

/// Both measurements combined by their information.
Feature both(const Feature& one, const Feature& other) {
    const double a = 1 / (one.sigma_px * one.sigma_px), b = 1 / (other.sigma_px * other.sigma_px);
    return {one.name, (a * one.position + b * other.position) / (a + b), 1 / std::sqrt(a + b),
            std::max(one.likelihood, other.likelihood)};
}

/// Where a hand would mark the outer corner of an eye that the networks saw; where they did not, as it is.
Eigen::Vector2d marked_corner(const FaceFeatures& face, const Feature& outer, double pupils) {
    const bool is_left = outer.name.ends_with(".L");
    const Feature* inner = face.find(is_left ? "eye_inner.L" : "eye_inner.R");
    if (inner == nullptr) return outer.position;
    const Eigen::Vector2d outward = (outer.position - inner->position).normalized();
    const Eigen::Vector2d down = (is_left ? 1 : -1) * Eigen::Vector2d(-outward.y(), outward.x());
    return outer.position + pupils * (kOuterCornerIn * outward + kOuterCornerUp * down);
}

bool are_elsewhere(const FaceFeatures& landmarks, const FaceFeatures& seen) {
    const Eigen::Vector2d across =
        pupil_of(landmarks, "pupil.L").position - pupil_of(landmarks, "pupil.R").position;
    for (const char* name : {"pupil.L", "pupil.R"}) {
        const Eigen::Vector2d off = pupil_of(seen, name).position - pupil_of(landmarks, name).position;
        if (off.norm() > kElsewhere * across.norm()) return true;
    }
    return false;
}

}  // namespace

FaceFeatures eye_features(const std::array<EyePoints, 2>& eyes, double presence) {
    for (const EyePoints& eye : eyes) {
        if (eye.contour.rows() < EyePoints::kRoundEye || eye.iris.rows() != EyePoints::kIris) {
            throw InvalidInput("the points are not those of an eye");
        }
    }
    const double pupils = (eyes[0].iris.row(0) - eyes[1].iris.row(0)).norm();
    FaceFeatures face;
    face.likelihood = presence;
    for (std::size_t e = 0; e < 2; ++e) {
        const std::string side = e == 0 ? ".L" : ".R";
        face.features.push_back({"pupil" + side, eyes[e].iris.row(0).transpose(),
                                 std::hypot(kGaze * pupils, kLeastSigma), presence});
        const double lid = std::hypot(eyes[e].lid_doubt * kLid * pupils, kLeastSigma);
        face.curves.push_back(curve_of("lid_upper" + side, eyes[e].contour, LidMargins::kUpper, lid));
        face.curves.push_back(curve_of("lid_lower" + side, eyes[e].contour, LidMargins::kLower, lid));
    }
    return face;
}

FaceFeatures network_features(const MeshPoints& mesh, const std::array<EyePoints, 2>& eyes) {
    if (mesh.places.rows() != MeshPoints::kCount) {
        throw InvalidInput("the points are not those of the network for the face mesh");
    }
    FaceFeatures face = eye_features(eyes, mesh.presence);
    const double pupils = (eyes[0].iris.row(0) - eyes[1].iris.row(0)).norm();
    const auto add = [&](const std::string& name, const Points2& places, int index, double part) {
        const double sigma_px = std::hypot(part * pupils, kLeastSigma);
        face.features.push_back({name, places.row(index).transpose(), sigma_px, mesh.presence});
    };
    for (std::size_t e = 0; e < 2; ++e) {
        const std::string side = e == 0 ? ".L" : ".R";
        add("eye_outer" + side, mesh.places, kOuterCorners[e], kEyeCorner);
        add("eye_inner" + side, mesh.places, kInnerCorners[e], kEyeCorner);
        add("mouth_corner" + side, mesh.places, kMouthCorners[e], kMouthCorner);
    }
    const auto add_lip = [&](const std::string& name, std::span<const int> line, const LipNoise& noise,
                             double drop = 0) {
        face.curves.push_back(lip_edge(name, mesh.places, line, noise, pupils, drop));
    };
    add_lip("lip_upper", LipEdges::kOuterUpper, kOuterLip);
    add_lip("lip_lower", LipEdges::kOuterLower, kOuterLip, kLowerEdge);
    add_lip("lip_upper_inner", LipEdges::kInnerUpper, kInnerLip);
    add_lip("lip_lower_inner", LipEdges::kInnerLower, kInnerLip);
    return face;
}

FaceFeatures local_features(const FaceFeatures& joined, int frames) {
    if (frames < 1)
        throw InvalidInput("there must be at least one frame, there are " + std::to_string(frames));
    const double pupils =
        (pupil_of(joined, "pupil.L").position - pupil_of(joined, "pupil.R").position).norm();
    const auto sigma = [&](double part) {
        return std::sqrt(frames) * std::hypot(part * pupils, kLeastSigma);
    };
    FaceFeatures local;
    local.box = joined.box;
    local.likelihood = joined.likelihood;
    const bool are_corners_seen = joined.find_curve(kOfTheMesh) != nullptr;
    for (Feature feature : joined.features) {
        if (!feature.name.starts_with("pupil.") && !are_corners_seen) continue;
        if (feature.name.starts_with("eye_outer.")) {
            feature.position = marked_corner(joined, feature, pupils);
        }
        if (feature.name.starts_with("eye_")) feature.sigma_px = sigma(kLocalEyeCorner);
        if (feature.name.starts_with("mouth_corner.")) feature.sigma_px = sigma(kMouthCorner);
        if (std::ranges::any_of(kLocal, [&](const char* name) { return feature.name.starts_with(name); })) {
            local.features.push_back(std::move(feature));
        }
    }
    for (FeatureCurve curve : joined.curves) {
        const bool is_lid = curve.name.starts_with("lid_"), is_inner = curve.name.ends_with("_inner");
        if (!is_lid && !curve.name.starts_with("lip_upper") && !curve.name.starts_with("lip_lower")) continue;
        curve.sigma_px.setConstant(sigma(is_lid ? kLocalLid : is_inner ? kLocalInnerLip : kLocalOuterLip));
        local.curves.push_back(std::move(curve));
    }
    return local;
}

Eigen::Vector2d eye_openings(const FaceFeatures& seen) {
    Eigen::Vector2d openings = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Eigen::Index eye : {0, 1}) {
        const std::string side = eye == 0 ? ".L" : ".R";
        const FeatureCurve *upper = seen.find_curve("lid_upper" + side),
                           *lower = seen.find_curve("lid_lower" + side);
        if (upper != nullptr && lower != nullptr && upper->points.rows() > 1 && lower->points.rows() > 0) {
            const double apart = (upper->points.colwise().mean() - lower->points.colwise().mean()).norm();
            const double width = (upper->points.bottomRows<1>() - upper->points.topRows<1>()).norm();
            openings[eye] = width > 0 ? apart / width : openings[eye];
        }
    }
    return openings;
}

FaceFeatures with_network_features(const FaceFeatures& landmarks, const FaceFeatures& seen) {
    if (seen.likelihood < kLeastPresence || are_elsewhere(landmarks, seen)) return landmarks;
    FaceFeatures joined = landmarks;
    joined.features.clear();
    joined.curves = seen.curves;
    for (const auto& feature : landmarks.features) {
        const Feature* by_networks = seen.find(feature.name);
        if (by_networks == nullptr) {
            if (seen.find_curve(feature.name) == nullptr) joined.features.push_back(feature);
        } else if (feature.name.starts_with("pupil.")) {
            joined.features.push_back(both(feature, *by_networks));
        }
    }
    for (const auto& feature : seen.features) {
        if (!feature.name.starts_with("pupil.")) joined.features.push_back(feature);
    }
    const bool is_mouth_seen = seen.find_curve(kOfTheMesh) != nullptr;
    for (const auto& curve : landmarks.curves) {
        if (curve.name == "jaw" || !is_mouth_seen) joined.curves.push_back(curve);
    }
    return joined;
}

}  // namespace mimetic
