// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/locate/feature_crops.hpp>
#include <mimetic/shared/image.hpp>
#include <string>

namespace mimetic {

struct FaceFeatures;

/// How probably something else is before a face, by cells of a square round it.
struct Occlusion {
    FeatureCrop square;
    Eigen::MatrixXf cells;  ///< 0 to 1, from the square's top left, rows downward; none: nobody has looked

    /// At a pixel of the picture, between the cells' middles; 0 beside the square.
    double at(const Eigen::Vector2d& pixel) const;

    /// The pixel of a place among the cells; their middles are at whole numbers.
    Eigen::Vector2d pixel_of(double row, double column) const;

    /// The share of a frontal face, 0 to 1, that is hidden by more than a probability.
    double share(double probability = .5) const;

    /// The share that is surely hidden, and from which something is before a face without doubt: of bare ones
    /// it is .05 at most, though smiles reach a probability of .5 over a fifth of one.
    static constexpr double kSure = .9, kLeastSure = .06;
    double sure_share() const { return share(kSure); }
    bool is_sure() const { return sure_share() >= kLeastSure; }
};

/// How far from the middle of a frontal face a place of its square is, which goes from 0 to 1 along both
/// sides: the face ends at 1.
double outward_of_face(const Eigen::Vector2d& share);

/// The square of a head that is at a pose, which the network was fitted to. Throws InvalidInput: the head is
/// behind the camera.
FeatureCrop occlusion_square(const Camera& camera, const Eigen::Isometry3d& camera_from_head);

/// About the same square of a face that was found.
FeatureCrop occlusion_square(const FaceFeatures& face);

/// A small network that was fitted to drawn people with painted hands, microphones, hair and things before
/// their faces, by `scripts/train_occlusion`. A call at a time: calls from several threads wait for each
/// other.
class OcclusionNetwork {
public:
    static constexpr int kCells = 24;

    /// Throws UnreadableMedia: missing, too large, or not such a network.
    explicit OcclusionNetwork(const std::string& file);
    ~OcclusionNetwork();
    OcclusionNetwork(OcclusionNetwork&&) noexcept;
    OcclusionNetwork& operator=(OcclusionNetwork&&) noexcept;

    /// square: `occlusion_square`. What is said of hair and background beside the face means nothing.
    /// Throws InvalidInput: the square lies beside the picture.
    Occlusion see(ColorView image, const FeatureCrop& square) const;

private:
    struct Net;
    std::unique_ptr<Net> net_;
};

}  // namespace mimetic
