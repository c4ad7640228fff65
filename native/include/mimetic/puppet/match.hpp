// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/shared/image.hpp>
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// A grey picture of its own: rows x cols.
struct GrayPicture {
    int rows = 0;
    int cols = 0;
    std::vector<std::uint8_t> pixels;

    GrayView view() const { return {pixels.data(), rows, cols, cols}; }
};

/// How part of a face looks, and where.
struct LookTemplate {
    GrayPicture picture;                              ///< 8 to 512 pixels a side
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of its centre, pixels of the images
    int group = 0;  ///< templates of one part of the face, which is at one place at a time
};

struct MatchOptions {
    double search_radius = 12;         ///< pixels of the image about the last place, 1 to 64
    std::vector<double> scales{1};     ///< sizes that are tried, relative to the template's, .5 to 2
    std::vector<double> rotations{0};  ///< rad that are tried, clockwise in the image, -pi/2 to pi/2
    int most_pixels = 700;     ///< larger templates are matched at half their size, or less, 64 to 16384
    double least_score = 0.5;  ///< below it a group is lost, -1 to 1
    bool follow = true;  ///< search windows follow their group and a lost one is searched for everywhere;
                         ///< false: they stay at the templates' places, as in a stabilised picture
    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// Where a template fits best.
struct TemplateMatch {
    double score = 0;                                 ///< normalised correlation at its peak, -1 to 1
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of the centre, pixels of the image
    double scale = 1;
    double rotation = 0;       ///< rad, clockwise in the image
    bool found_again = false;  ///< by a search of the whole image
};

/// Normalised correlation [Lewis 1995] of a template with every window of an image of its size:
/// (rows - template rows + 1) x (cols - template cols + 1), -1 to 1; 0 where the image is flat.
MatrixRows correlation_map(const GrayView& image, const GrayView& picture);

/// Matches templates with images, one after the other. Sums and squares of each size of the image are
/// computed once for all templates; gain and offset of the light change no score.
class TemplateMatcher {
public:
    /// Throws InvalidInput: which template, which field.
    TemplateMatcher(const std::vector<LookTemplate>& templates, const MatchOptions& options = {});
    ~TemplateMatcher();
    TemplateMatcher(TemplateMatcher&&) noexcept;
    TemplateMatcher& operator=(TemplateMatcher&&) noexcept;

    /// The peak of each template, in their order. Images may change in size.
    std::vector<TemplateMatch> match(const GrayView& image);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace mimetic
