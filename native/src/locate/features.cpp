// SPDX-License-Identifier: GPL-3.0-or-later
#include <mimetic/shared/error.hpp>

#include "locate/measure.hpp"

namespace mimetic {
namespace locate {
namespace {

/// Measured features as they are passed out: pixels of the image.
FaceFeatures to_image(const FacePatch& patch, const Features& features, const Curves& curves) {
    FaceFeatures face;
    const double px = patch.image_px_per_ipd();
    const Eigen::Matrix2d turn = patch.turn / patch.turn.col(0).norm();
    for (const auto& [name, measured] : features) {
        face.features.push_back(
            {name, patch.to_image(measured.position), measured.sigma * px, measured.likelihood});
    }
    for (const auto& [name, measured] : curves) {
        FeatureCurve curve{name, measured.line.points, measured.line.normals,
                           Eigen::VectorXd(measured.line.points.rows())};
        for (int i = 0; i < curve.points.rows(); ++i) {
            curve.points.row(i) = patch.to_image(measured.line.points.row(i));
            curve.normals.row(i) = turn * measured.line.normals.row(i).transpose();
            curve.sigma_px(i) = measured.sigma[static_cast<std::size_t>(i)] * px;
        }
        face.curves.push_back(std::move(curve));
    }
    return face;
}

}  // namespace

FaceFeatures measure_in_patch(const FacePatch& patch, const Expected& expected, MeasuredParts parts) {
    Features features;
    Curves curves;
    if (parts == MeasuredParts::all) {
        measure_irises(patch, expected, features);
        measure_brows(patch, expected, curves);
        measure_nose(patch, expected, features);
    }
    measure_mouth(patch, expected, features, curves);
    measure_jaw(patch, expected, curves);
    return to_image(patch, features, curves);
}

}  // namespace locate

const Feature* FaceFeatures::find(const std::string& name) const {
    for (const auto& feature : features) {
        if (feature.name == name) return &feature;
    }
    return nullptr;
}

const FeatureCurve* FaceFeatures::find_curve(const std::string& name) const {
    for (const auto& curve : curves) {
        if (curve.name == name) return &curve;
    }
    return nullptr;
}

FaceFeatures measure_features(ColorView image, const FaceFeatures& expected, double search,
                              MeasuredParts parts) {
    check_image_size(image.rows, image.cols, "image");
    const Feature* right = expected.find("pupil.R");
    const Feature* left = expected.find("pupil.L");
    if (right == nullptr || left == nullptr || (left->position - right->position).norm() < 4) {
        throw InvalidInput("expected features must hold pupil.R and pupil.L at least 4 pixels apart");
    }
    const auto refuse = [](const std::string& name) {
        throw InvalidInput("expected " + name + " is not finite: the fit before has failed");
    };
    for (const auto& feature : expected.features) {
        if (!feature.position.allFinite()) refuse(feature.name);
    }
    for (const auto& curve : expected.curves) {
        if (curve.points.rows() < 2 || !curve.points.allFinite()) refuse(curve.name);
    }
    if (!(search > 0 && search <= 1)) {
        throw InvalidInput("search is " + std::to_string(search) +
                           "; it must be above 0 and at most 1 (IPD)");
    }
    const locate::FacePatch patch = locate::make_patch(image, right->position, left->position);
    locate::Expected near = locate::average_face();
    near.search = search;
    for (const auto& feature : expected.features)
        near.features[feature.name] = patch.to_ipd(feature.position);
    for (const auto& curve : expected.curves) {
        Points2 points(curve.points.rows(), 2);
        for (int i = 0; i < points.rows(); ++i) points.row(i) = patch.to_ipd(curve.points.row(i));
        near.curves[curve.name] = points;
    }
    FaceFeatures face = locate::measure_in_patch(patch, near, parts);
    face.box = expected.box;
    face.likelihood = expected.likelihood;
    return face;
}

}  // namespace mimetic
