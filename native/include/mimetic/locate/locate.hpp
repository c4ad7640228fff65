// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/locate/face_spaces.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>
#include <vector>

namespace mimetic {

/// A named point of the face in the image. Names end in the subject's own side, `.L` or `.R`.
struct Feature {
    std::string name;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< pixels
    double sigma_px = 1;                                 ///< standard deviation of the position
    double likelihood = 0;                               ///< 0 guessed from proportions to 1 clearly visible
};

/// A line of the face in the image (`jaw`, `lip_line`, `brow.L`, ...); only its position along `normals` is
/// measured.
struct FeatureCurve {
    std::string name;
    Points2 points;            ///< N x 2, pixels
    Points2 normals;           ///< N x 2, unit; of `jaw`: out of the face
    Eigen::VectorXd sigma_px;  ///< N, standard deviation along the normal
};

/// What is measured of one face.
struct FaceFeatures {
    Eigen::Vector4d box =
        Eigen::Vector4d::Zero();  ///< left, top, width, height of the detector's square, pixels
    double likelihood = 0;        ///< 0 to 1: face seen, both eyes and mouth where they should be
    double yaw = 0;               ///< degrees, of the view that fits best; 0 without eigenspaces
    double roll = 0;              ///< radians, clockwise in the picture
    std::vector<Feature> features;
    std::vector<FeatureCurve> curves;

    const Feature* find(const std::string& name) const;  ///< nullptr if there is none
    const FeatureCurve* find_curve(const std::string& name) const;
};

struct LocateOptions {
    double smallest_face = 0.12;    ///< least width of a face as a part of the image's shorter side
    double least_likelihood = 0.3;  ///< faces below are dropped
    void check() const;             ///< throws InvalidInput: field, value, limit
};

/// Finds faces by eigenspaces and OpenCV's Haar cascade together, or by the cascades alone, and measures
/// eyes, brows, nose, mouth and jaw in them.
class FaceLocator {
public:
    /// cascade_directory: holds haarcascade_frontalface_alt2.xml and haarcascade_eye.xml. Throws
    /// InvalidInput.
    explicit FaceLocator(const std::string& cascade_directory, const LocateOptions& options = {});
    /// Uses eigenspaces too: they find faces turned further, and eyes and mouth more accurately.
    FaceLocator(const std::string& cascade_directory, FaceSpaces spaces, const LocateOptions& options = {});
    ~FaceLocator();
    FaceLocator(FaceLocator&&) noexcept;
    FaceLocator& operator=(FaceLocator&&) noexcept;

    /// Every face, the largest first; from several threads at once if need be. A grey image comes as three
    /// equal channels. A badly lit face is measured in a picture in which it is well lit (`well_lit`). Where
    /// there is none, it is looked for in shadows and fog, and then one that fills the image, whose box may
    /// go beyond.
    std::vector<FaceFeatures> locate(ColorView image) const;

private:
    struct Cascades;
    struct CascadePairs;

    std::vector<FaceFeatures> search(ColorView image, const LocateOptions& options) const;

    std::unique_ptr<CascadePairs> cascades_;
    std::unique_ptr<FaceFinder> finder_;  // empty: cascades alone
    LocateOptions options_;
};

enum class MeasuredParts {
    all,
    mouth_and_jaw,
};

/// Measures the features again, near where a fitted model predicts them.
/// expected: at least the features `pupil.L` and `pupil.R`; the other features and curves guide the search.
/// search: half width of the search, in interpupillary distances.
FaceFeatures measure_features(ColorView image, const FaceFeatures& expected, double search = 0.1,
                              MeasuredParts parts = MeasuredParts::all);

}  // namespace mimetic
