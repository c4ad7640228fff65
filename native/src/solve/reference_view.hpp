// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <opencv2/core.hpp>

#include "face_state.hpp"
#include "locate/likeness.hpp"

namespace mimetic {

/// A grey frame, made smaller when the face in it has many more pixels than the reference textures.
struct PreparedFrame {
    cv::Mat1b gray;
    double scale = 1;  ///< of gray to the camera's image

    void update(const cv::Mat1b& full, double wanted_scale);
};

/// Normalises local brightness and contrast inside a mask, so that lighting may change.
class LocalNormaliser {
public:
    explicit LocalNormaliser(const cv::Mat1b& mask, int window);
    /// values: about zero mean, standard deviation kContrast where there is texture; 0 outside the mask.
    void apply(const cv::Mat1f& image, cv::Mat1f& values);
    static constexpr float kContrast = 40;

private:
    int window_;
    cv::Mat1f mask_, soft_mask_, inverse_count_;
    cv::Mat1f masked_, squared_, mean_, variance_;
};

/// Where a reference texture is measured.
struct ReferenceSample {
    int x = 0;  ///< crop pixel
    int y = 0;
    int triangle = 0;
    Eigen::Vector3f barycentric;
    SkinPoint skin;
    Eigen::Matrix3Xf seen_modes;         ///< 3 x M: the modes as a flow shows them, blurred
    Eigen::Matrix3Xf seen_detail_modes;  ///< 3 x D
    float weight = 1;
    bool is_behind_rim = false;  ///< of glasses: what is seen here turns with the head, not with the skin
    /// Head frame, metres: displacement of the skin from the model when the texture was taken.
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
};

/// Where a sample is in the picture, pixels.
Eigen::Vector2f place_of(const ReferenceSample& sample, const Triangles& triangles,
                         const ProjectedSurface& projected);

/// The face's texture as one frame showed it, each pixel tied to the skin.
class ReferenceView {
public:
    ReferenceView(const FaceSurface& surface, const Camera& camera, const FaceState& state,
                  const cv::Mat1b& gray, int crop_height, int spacing,
                  double flow_blur);  ///< crop pixels

    /// Takes the detail (D) at the time of the texture as part of what its samples show from then on.
    void keep_detail(const Eigen::VectorXd& coefficients);

    /// Fetches the texture of a frame under the hypothesis `projected`; map: frame pixel of each crop pixel.
    /// for_flow: as `flow_texture` is, otherwise as `texture`.
    void stabilise(const Triangles& triangles, const ProjectedSurface& projected, const PreparedFrame& frame,
                   cv::Mat2f& map, cv::Mat1f& texture, bool for_flow = false);
    /// What was fetched last, as `flow_texture` is.
    void normalise_for_flow(cv::Mat1f& texture);

    /// Of each pixel of the texture: of a sample its weight times how well it is seen (visible, of each
    /// sample).
    cv::Mat1f sample_weights(const std::vector<float>& visible) const;

    const Eigen::Isometry3d& camera_from_head() const { return camera_from_head_; }
    /// The texture to compare others with.
    const ReferenceTexture& texture() const { return texture_; }
    /// The texture that flow is measured from: without the rims of glasses, whose contrast would drown that
    /// of the skin about them.
    const ReferenceTexture& flow_texture() const { return flow_normaliser_ ? flow_texture_ : texture_; }
    /// Whether flow has more of what is fine: light is taken out over less of the face.
    bool has_finer_flow_texture() const { return has_finer_flow_texture_; }
    const cv::Mat1b& mask() const { return mask_; }
    const std::vector<ReferenceSample>& samples() const { return samples_; }
    double scale() const { return scale_; }  ///< crop pixels an image pixel
    const Eigen::Vector2d& origin() const { return origin_; }

private:
    /// Which crop pixels are within `reach` (metres) of rims of glasses.
    cv::Mat1b rims_drawn(const std::vector<Points>& rims, const Camera& camera, double reach) const;
    void choose_samples(const FaceSurface& surface, const ProjectedSurface& projected, int spacing,
                        const cv::Mat1b& rims);
    void blur_modes(double flow_blur);

    Eigen::Isometry3d camera_from_head_;
    Eigen::Vector2d origin_;  // image pixel of crop pixel (0, 0)
    double scale_ = 1;
    cv::Mat1i triangle_;  // -1 where the skin is not seen or not measured
    cv::Mat3f barycentric_;
    cv::Mat1b mask_;
    ReferenceTexture texture_;
    std::vector<ReferenceSample> samples_;
    std::unique_ptr<LocalNormaliser> normaliser_;
    std::unique_ptr<LocalNormaliser> flow_normaliser_;  // none: it would be the same
    bool has_finer_flow_texture_ = false;
    ReferenceTexture flow_texture_;
    cv::Mat1f raw_;
    cv::Mat2f scaled_map_;
};

}  // namespace mimetic
