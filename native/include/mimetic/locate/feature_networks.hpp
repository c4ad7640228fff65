// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <memory>
#include <mimetic/locate/feature_crops.hpp>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <string>

namespace mimetic {

/// The points of MediaPipe's face mesh; the subject's right first, as in the image.
struct MeshPoints {
    static constexpr int kCount = 468;
    Points2 places;                 ///< 468 x 2, pixels of the picture; lips and eyes refined, if asked for
    Eigen::VectorXd depth;          ///< 468, pixels, the network's estimate: smaller is nearer
    double presence = 0;            ///< 0 to 1: probability of a face in the crop
    std::array<Points2, 2> irises;  ///< 5 x 2, pixels, as EyePoints', left first; empty unless asked for
};

/// Edges of the lips among the mesh's points, each from the subject's right corner of the mouth to the left.
struct LipEdges {
    using Edge = std::array<int, 11>;
    static constexpr Edge kOuterUpper{61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291};
    static constexpr Edge kInnerUpper{78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308};
    static constexpr Edge kInnerLower{78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308};
    static constexpr Edge kOuterLower{61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291};
};

/// The lids' margins among an eye's contour points, from the outer to the inner corner: the contour begins at
/// the outer corner, runs along the lower lid and back along the upper one.
struct LidMargins {
    using Margin = std::array<int, 9>;
    static constexpr Margin kUpper{0, 9, 10, 11, 12, 13, 14, 15, 8};
    static constexpr Margin kLower{0, 1, 2, 3, 4, 5, 6, 7, 8};
};

/// What MediaPipe's iris network, or a regressor of ours, measures of one eye.
struct EyePoints {
    static constexpr int kContour = 71, kRoundEye = 16;
    static constexpr int kIris = 5;
    Points2 contour;        ///< 71 x 2, pixels: of lids and brow, the first 16 round the eye
    Points2 iris;           ///< 5 x 2, pixels: centre, then four points of its rim
    double lid_doubt = 1;   ///< times the network's usual error, of the lids' margins
    double iris_doubt = 1;  ///< the same of the iris
};

/// Files of what refines mesh and eyes; an empty name leaves one out.
struct HeadFiles {
    std::string lips;                 ///< attention head of the lips
    std::array<std::string, 2> eyes;  ///< of the eyes, the left first
    std::string eye_points;           ///< regressor of lids and iris, fitted to drawn people
};

/// Google's networks for face mesh and iris (Apache-2.0), as `scripts/make_networks` turns them into ONNX.
/// They were trained on real faces; they are evidence with an error of their own, never the head's pose.
/// A call of each at a time: calls of one network from several threads wait for each other.
class FeatureNetworks {
public:
    /// Files of the networks. Throws UnreadableMedia: missing, too large, or not such a network.
    FeatureNetworks(const std::string& mesh_file, const std::string& iris_file, const HeadFiles& heads = {});
    ~FeatureNetworks();
    FeatureNetworks(FeatureNetworks&&) noexcept;
    FeatureNetworks& operator=(FeatureNetworks&&) noexcept;

    /// The whole face. crop: as `feature_crops` places it. refine_eyes: refine the eyes too and measure the
    /// irises; the corners become more accurate, while for lids `eye` is better.
    MeshPoints mesh(ColorView image, const FeatureCrop& crop, bool refine_eyes = false) const;

    /// One eye, by the iris network and, where its file was given, the regressor that was fitted to drawn
    /// people: margins of the lids are joined, each by its error. left: the subject's left eye, which is
    /// mirrored for both.
    EyePoints eye(ColorView image, const FeatureCrop& crop, bool left) const;

private:
    struct Nets;
    std::unique_ptr<Nets> nets_;
};

}  // namespace mimetic
