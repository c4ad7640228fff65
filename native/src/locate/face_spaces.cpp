// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <cmath>
#include <mimetic/locate/face_spaces.hpp>
#include <mimetic/shared/error.hpp>

#include "locate/flatten.hpp"

namespace mimetic {
namespace {

constexpr int kMostViews = 9;
constexpr int kMostModules = 6;

void need(bool holds, const std::string& what) {
    if (!holds) throw InvalidInput("spaces of faces: " + what);
}

bool is_of_size(const Eigenspace& a, const Eigenspace& b) {
    return a.width == b.width && a.height == b.height;
}

void check_view(const ViewSpace& view, const Eigenspace& other, Eigen::Index num_modules) {
    view.space.check();
    const std::string name = "the view at " + std::to_string(view.yaw) + " degrees";
    need(std::isfinite(view.yaw) && std::isfinite(view.threshold), "a yaw or threshold is not finite");
    need(view.space.width == view.space.height && is_of_size(view.space, other),
         name + " and the other windows must be square and of one size");
    need(view.filter.size() == view.space.mean.size() && view.filter.allFinite(),
         name + " needs a finite filter of its window's size");
    need(view.places.size() == 2 * num_modules && view.covariance.rows() == 2 * num_modules &&
             view.covariance.cols() == 2 * num_modules && view.places.allFinite() &&
             view.covariance.allFinite(),
         name + " needs a finite place and covariance of every module");
    need(view.places.size() == 0 || view.places.cwiseAbs().maxCoeff() <= 1,
         name + " has a module outside of twice its window");
    const Eigen::LLT<Eigen::MatrixXd> factor(view.covariance);
    need(factor.info() == Eigen::Success, name + " has a covariance that is not positive definite");
}

}  // namespace

Eigen::Index FaceSpaces::module(const std::string& name) const {
    for (std::size_t i = 0; i < modules.size(); ++i) {
        if (modules[i].name == name) return static_cast<Eigen::Index>(i);
    }
    throw InvalidInput("spaces of faces: there is no module " + name);
}

void FaceSpaces::check() const {
    need(!views.empty() && views.size() <= kMostViews, "1 to 9 views are needed");
    need(!modules.empty() && modules.size() <= kMostModules, "1 to 6 modules are needed");
    other.check();
    for (const auto& view : views) check_view(view, other, static_cast<Eigen::Index>(modules.size()));
    const double px = modules[0].space.width / modules[0].width;
    for (const auto& module : modules) {
        module.space.check();
        module.other.check();
        need(is_of_size(module.space, module.other), module.name + " and its surroundings differ in size");
        need(module.width > 0.01 && module.width <= 1, module.name + " has a width outside 0.01 to 1");
        need(std::abs(module.space.width / module.width - px) < 0.01 * px && px <= 256,
             module.name + " has pixels of another size than " + modules[0].name);
    }
    need(weights.size() == evidence_size() + 1 && weights.allFinite(),
         std::to_string(evidence_size() + 1) + " finite weights are needed");
}

void FaceSearch::check() const {
    need(smallest >= 16 && smallest <= 16384, "smallest must be 16 to 16384 pixels");
    need(largest > 0 && largest <= 1, "largest is a part of the image's shorter side, above 0 to 1");
    need(steps_per_octave >= 1 && steps_per_octave <= 32, "steps_per_octave must be 1 to 32");
    need(std::abs(roll) <= 3.2, "roll must be within half a turn");
    need(least_probability >= 0 && least_probability <= 1, "least_probability must be 0 to 1");
}

std::vector<FlatLevel> flat_levels(GrayView image, int side, const FaceSearch& options) {
    check_image_size(image.rows, image.cols, "image");
    options.check();
    need(side >= 8 && side <= 128, "windows must be 8 to 128 pixels wide");
    const locate::Pyramid pyramid(locate::float_image(image));
    std::vector<FlatLevel> made;
    for (const auto& level :
         locate::levels(pyramid, side, options.smallest, options.largest * std::min(image.rows, image.cols),
                        options.steps_per_octave)) {
        made.push_back({locate::values_of(level.flat), level.width});
    }
    return made;
}

MatrixRows flat_window(GrayView image, const Eigen::Vector2d& center, double width, double roll, int cols,
                       int rows, double ipd_px) {
    check_image_size(image.rows, image.cols, "image");
    need(center.allFinite() && std::isfinite(roll) && width >= 4 && width <= 16384,
         "a window's place must be finite and its width 4 to 16384 pixels");
    need(cols >= 2 && rows >= 2 && cols <= 256 && rows <= 256 && ipd_px >= 2 && ipd_px <= 128,
         "a window has sides of 2 to 256 pixels, and pupils 2 to 128 apart");
    const locate::Pyramid pyramid(locate::float_image(image));
    return locate::values_of(pyramid.window(center, width / cols, roll, {cols, rows}, ipd_px));
}

}  // namespace mimetic
