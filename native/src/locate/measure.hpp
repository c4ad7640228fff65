// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <mimetic/locate/locate.hpp>
#include <optional>

#include "locate/patch.hpp"

namespace mimetic::locate {

/// Where things are expected in the patch: in IPD from the mid-eye point, x right, y down.
struct Expected {
    std::map<std::string, Eigen::Vector2d> features;
    std::map<std::string, Points2> curves;
    double search = 0.2;  ///< half width of the search, IPD

    Eigen::Vector2d at(const std::string& name) const { return features.at(name); }
};

/// Proportions of a frontal adult face [Farkas 1994, means], before anything but the eyes is known.
Expected average_face();

/// A measurement in the patch, IPD.
struct Measured {
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    double sigma = 0.05;
    double likelihood = 0;
};
struct MeasuredCurve {
    Polyline line;
    std::vector<double> sigma;
};
using Features = std::map<std::string, Measured>;
using Curves = std::map<std::string, MeasuredCurve>;

/// Features and curves of one face, in pixels of the image.
FaceFeatures measure_in_patch(const FacePatch& patch, const Expected& expected,
                              MeasuredParts parts = MeasuredParts::all);

void measure_irises(const FacePatch& patch, const Expected& expected, Features& features);
void measure_mouth(const FacePatch& patch, const Expected& expected, Features& features, Curves& curves);
void measure_nose(const FacePatch& patch, const Expected& expected, Features& features);
void measure_brows(const FacePatch& patch, const Expected& expected, Curves& curves);
void measure_jaw(const FacePatch& patch, const Expected& expected, Curves& curves);

}  // namespace mimetic::locate
