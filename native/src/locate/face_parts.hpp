// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/locate/face_spaces.hpp>

#include "locate/batch_space.hpp"
#include "locate/flatten.hpp"

namespace mimetic::locate {

struct PartPlaces {
    Points2 places;             ///< from the middle of the face's window, in its widths, upright
    Eigen::VectorXd log_ratio;  ///< of each module at its place: likelihood as itself over as another
    double prior = 0;           ///< squared Mahalanobis distance from the view's places
};

/// Spaces of the modules, ready for many windows.
class FaceParts {
public:
    explicit FaceParts(const FaceSpaces& spaces);
    /// The places that make log ratios and prior together largest.
    PartPlaces place(const Pyramid& pyramid, const Eigen::Vector2d& center, double width, double roll,
                     const ViewSpace& view) const;

private:
    struct Module {
        BatchSpace space;
        BatchSpace other;
        cv::Size size;
    };
    std::vector<Module> modules_;
    double px_ = 0;  ///< window pixels in one width of the face's window
};

}  // namespace mimetic::locate
