// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/locate/eigenspace.hpp>
#include <mimetic/shared/image.hpp>
#include <string>
#include <vector>

namespace mimetic {

// Every window below is cut from an image whose contrast has been flattened: each grey value less the mean
// of its surroundings, over their standard deviation. That removes shading and exposure, which dominate the
// first principal components of plain grey values.

/// The whole face under one yaw.
struct ViewSpace {
    double yaw = 0;          ///< degrees
    Eigen::VectorXd filter;  ///< N: Fisher's linear discriminant of a window, above `threshold` for faces
    double threshold = 0;    ///< windows whose product with `filter` is below are no faces
    Eigenspace space;        ///< of square windows
    Eigen::VectorXd places;  ///< mean of the parts (x0, y0, x1, ...), from the middle, in window widths
    MatrixRows covariance;   ///< of these
};

/// A part of the face: its appearance, and that of its surroundings.
struct ModuleSpace {
    std::string name;
    Eigenspace space;
    Eigenspace other;
    double width = 0.3;  ///< of its window, in widths of the face's window
};

/// View-based and modular eigenspaces, with those of false positives [Moghaddam and Pentland 1997].
struct FaceSpaces {
    std::vector<ViewSpace> views;      ///< 1 to 9, of one size
    Eigenspace other;                  ///< windows without a face that pass the filters, of the same size
    std::vector<ModuleSpace> modules;  ///< 1 to 6
    Eigen::VectorXd weights;           ///< of evidence_size() numbers, and a constant: log odds of a face
    int evidence_size() const { return 7 + static_cast<int>(modules.size()); }
    Eigen::Index module(const std::string& name) const;  ///< throws InvalidInput if there is none
    void check() const;                                  ///< throws InvalidInput: field, value, limit
};

/// A square that another finder reports as a face.
struct FaceHint {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< of the face's window, pixels
    double width = 0;                                  ///< of the face's window, pixels
    double votes = 0;
};

struct FaceSearch {
    double smallest = 48;            ///< width of the window in the image, pixels; two pupil distances
    double largest = 0.9;            ///< part of the image's shorter side
    int steps_per_octave = 4;        ///< scales between a size and its double
    double roll = 0;                 ///< radians, about which the search in roll is centred
    double least_probability = 0.5;  ///< faces below are dropped
    void check() const;              ///< throws InvalidInput: field, value, limit
};

/// A face: place, size, rotation, and the evidence for it.
struct FoundFace {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< of its window, pixels
    double width = 0;                                  ///< of its window, pixels
    double roll = 0;                                   ///< radians, clockwise in the picture
    double yaw = 0;                                    ///< degrees, of the view that fits best
    double probability = 0;
    Points2 places;            ///< pixels, a row a module
    Eigen::VectorXd evidence;  ///< the numbers that `weights` multiplies
};

/// Maximum-likelihood search for faces over place, size, roll and view.
class FaceFinder {
public:
    explicit FaceFinder(FaceSpaces spaces);  ///< throws InvalidInput
    ~FaceFinder();
    FaceFinder(FaceFinder&&) noexcept;
    FaceFinder& operator=(FaceFinder&&) noexcept;

    const FaceSpaces& spaces() const;
    /// Faces that do not overlap, the most probable first. hints: further squares to try.
    std::vector<FoundFace> find(GrayView image, const FaceSearch& options = {},
                                const std::vector<FaceHint>& hints = {}) const;
    /// The same face in another frame, within a third of its width and a fifth of its size; empty without.
    std::vector<FoundFace> find_near(GrayView image, const FoundFace& before,
                                     double least_probability = 0.5) const;

private:
    struct Batch;
    std::unique_ptr<const FaceSpaces> spaces_;  // its address stays when the finder is moved
    std::unique_ptr<Batch> batch_;
};

/// The pyramid levels that the search uses, contrast flattened: of an image, for windows `side` pixels
/// wide that are `smallest` to `largest` wide in the image. For training.
struct FlatLevel {
    MatrixRows values;
    double width = 0;  ///< of a window, pixels of the image
};
std::vector<FlatLevel> flat_levels(GrayView image, int side, const FaceSearch& options);

/// A window of flattened contrast cols x rows, row by row; NaN-free. For training.
/// width: of the window in the image, pixels; ipd_px: pupil distance in pixels of the window.
MatrixRows flat_window(GrayView image, const Eigen::Vector2d& center, double width, double roll, int cols,
                       int rows, double ipd_px);

}  // namespace mimetic
