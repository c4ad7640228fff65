// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mimetic/locate/rest.hpp>
#include <mimetic/shared/error.hpp>
#include <numeric>

#include "shared/robust.hpp"

namespace mimetic {

namespace {

/// Upper limit of a sign in faces at rest, and how fast the score falls beyond it (real webcam clips):
/// relative to the cheek's brightness.
struct AtRest {
    double RestSigns::* sign;
    double usual;
    double spread;
};
// Sharpening multiplies these. Contrast of the mouth: two lips and a line; teeth or an open mouth's dark add
// to it. Of the cheek: the smile's fold.
constexpr AtRest kContrasts[] = {{&RestSigns::mouth_contrast, .13, .03},
                                 {&RestSigns::mouth_edges, .09, .02},
                                 {&RestSigns::cheek_contrast, .09, .04}};
// Closed lids are as bright as skin. On dark skin and in few pixels open eyes, too, are brighter than usual.
constexpr AtRest kPupils{&RestSigns::pupil_brightness, .33, .08};
constexpr double kLeastAtRest = .2;  // of a clip's frames: their contrasts are those of this footage at rest
constexpr double kSmiles = 1.25;     // of the usual: to 1.24 where somebody smiles all along, unsharpened
constexpr double kOpenEyes = .25;    // of a clip's frames have pupils darker than what is usual in open eyes
constexpr double kLevel = .25;       // rad
constexpr double kFrontal = .1, kMouthFrontal = .12;  // pupil distances off the middle
constexpr double kSmooth =
    .75;  // of the second differences in a face: borders of an encoder's blocks are above
constexpr double kDetailed = .75;      // of a clip's frames have less detail than its detailed ones
constexpr double kLeastSpread = .015;  // pupil distances by which a still face's features seem to move
constexpr double kUsual = 1.5;         // spreads
constexpr double kLeastRest = .1;      // of the best frame's score: below, a face is clearly not at rest

// By what moves, chosen on `mimetic evaluate rest --set tuning` and `--set real` together. Scores and detail
// count for little there, but in WolfgangLanger_Pexels.mp4 they tell a hand before the mouth.
constexpr double kSameState = .13;    // activation by which a state that recurs differs
constexpr double kRelaxed = .2;       // of a clip's frames have less of a value than its relaxed ones
constexpr double kPerExcess = 2;      // cost of an activation above that
constexpr double kPerLid = 20;        // cost of a lid's way to shut, beyond what a look aside takes
constexpr double kLidAtRest = .25;    // of it, beside its place in the more open frames
constexpr double kOpenLid = .25;      // of a clip's frames are these: somebody may weep for half of it
constexpr double kPerScore = .5;      // of the logarithm of rest_scores
constexpr double kPerDetail = .4;     // of the logarithm of what there is of the detail
constexpr double kLeastShare = 1e-9;  // whose logarithm is taken

using Window = Eigen::Array<double, 41, 41, Eigen::RowMajor>;

/// Grey level of a pixel, ITU-R BT.601.
double grey_at(ColorView image, int x, int y) {
    const std::uint8_t* pixel = image.row(y) + 3 * x;
    return .299 * pixel[0] + .587 * pixel[1] + .114 * pixel[2];
}

Eigen::Vector2d place_of(const FaceFeatures& face, const std::string& name) {
    const Feature* feature = face.find(name);
    if (feature == nullptr) {
        throw InvalidInput("the face has no feature " + name);
    }
    return feature->position;
}

double deviation(const auto& values) { return std::sqrt((values - values.mean()).square().mean()); }

/// The picture in pupil distances from the mid-eye point, x right, y down.
class FaceFrame {
public:
    FaceFrame(ColorView image, const FaceFeatures& face)
        : image_(image),
          face_(face),
          middle_((place_of(face, "pupil.R") + place_of(face, "pupil.L")) / 2),
          across_(place_of(face, "pupil.L") - place_of(face, "pupil.R")),
          down_(-across_.y(), across_.x()) {}

    Eigen::Vector2d place(const std::string& name) const {
        const Eigen::Vector2d away = place_of(face_, name) - middle_;
        return Eigen::Vector2d(across_.dot(away), down_.dot(away)) / across_.squaredNorm();
    }

    double midway(const std::string& name) const {
        return (place(name + ".L").x() + place(name + ".R").x()) / 2;
    }

    double roll() const { return std::atan2(across_.y(), across_.x()); }

    /// Grey values round a point, held at the border.
    Window window(double x, double y, double half_x, double half_y) const {
        Window values;
        for (int row = 0; row < values.rows(); ++row) {
            for (int column = 0; column < values.cols(); ++column) {
                const Eigen::Vector2d spot = middle_ + (x + half_x * (column - 20) / 20.) * across_ +
                                             (y + half_y * (row - 20) / 20.) * down_;
                const double right = std::clamp(std::nearbyint(spot.x()), 0., image_.cols - 1.);
                const double down = std::clamp(std::nearbyint(spot.y()), 0., image_.rows - 1.);
                values(row, column) = grey_at(image_, static_cast<int>(right), static_cast<int>(down));
            }
        }
        return values;
    }

private:
    ColorView image_;
    const FaceFeatures& face_;
    Eigen::Vector2d middle_, across_, down_;
};

/// The score's factor of a sign, 0 to 1.
double beyond(double value, const AtRest& rest) {
    const double off = std::max(0., value - rest.usual) / rest.spread;
    return std::exp(-.5 * off * off);
}

/// Quantile of a sign over a clip's frames.
double quantile_of(const std::vector<RestSigns>& frames, double RestSigns::* sign, double share) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const RestSigns& signs : frames) {
        values.push_back(signs.*sign);
    }
    return quantile(std::move(values), share);
}

/// By what all contrasts of a clip's frames are multiplied, beyond what smiles add; 1 at least. One contrast
/// alone may be this face's own, such as a beard's.
double sharpening(const std::vector<RestSigns>& frames) {
    std::vector<double> shares;
    shares.reserve(std::size(kContrasts));
    for (const AtRest& contrast : kContrasts) {
        shares.push_back(quantile_of(frames, contrast.sign, kLeastAtRest) / contrast.usual);
    }
    return std::max(1., median(std::move(shares)) / kSmiles);
}

/// The upper limit of the pupils' brightness in open eyes, which a clip's darker ones show.
AtRest open_pupils(const std::vector<RestSigns>& frames) {
    const double usual = quantile_of(frames, kPupils.sign, kOpenEyes);
    return {kPupils.sign, std::max(kPupils.usual, usual), kPupils.spread};
}

/// Which of a clip's frames determine the usual expression.
std::vector<int> informative_frames(VectorIn scores) {
    std::vector<int> frames;
    for (int f = 0; f < scores.size(); ++f) {
        if (scores[f] >= kLeastRest * scores.maxCoeff()) {
            frames.push_back(f);
        }
    }
    if (2 * frames.size() >= static_cast<std::size_t>(scores.size())) {
        frames.resize(static_cast<std::size_t>(scores.size()));
        std::iota(frames.begin(), frames.end(), 0);
    }
    return frames;
}

/// How far each frame's expression is from one of them, spreads, rms of what was found in both.
Eigen::ArrayXd away_from(const Expressions& expressions, Eigen::Index frame) {
    Eigen::ArrayXd away(expressions.rows());
    for (Eigen::Index other = 0; other < expressions.rows(); ++other) {
        Eigen::Array<double, 1, 6> apart =
            (expressions.row(frame) - expressions.row(other)).array() / kLeastSpread;
        apart = apart.isNaN().select(0, apart);
        away[other] = std::sqrt(apart.square().mean());
    }
    return away;
}

/// Which frames have a frame's expression, but for what a still face's features seem to move.
Eigen::ArrayX<bool> alike(const Expressions& expressions, Eigen::Index frame) {
    return away_from(expressions, frame) <= 1;
}

void check_frame(const Expressions& expressions, Eigen::Index frame) {
    if (frame < 0 || frame >= expressions.rows()) {
        throw InvalidInput("the frame must be one of those with an expression");
    }
}

/// Of each frame's detail, what the clip's better frames have, up to 1.
Eigen::ArrayXd shares_of_detail(VectorIn details) {
    return (details.array() / std::max(quantile({details.begin(), details.end()}, kDetailed), 1e-6)).min(1);
}

void check_sizes(const Expressions& expressions, VectorIn values) {
    if (expressions.rows() != values.size() || values.size() == 0) {
        throw InvalidInput("there must be an expression and a number for each of some frames");
    }
}

}  // namespace

RestSigns rest_signs(ColorView image, const FaceFeatures& face) {
    const FaceFrame frame(image, face);
    const double off_nose = frame.midway("ala") / kFrontal,
                 off_mouth = frame.midway("mouth_corner") / kMouthFrontal, off_level = frame.roll() / kLevel;
    const double frontal =
        face.likelihood *
        std::exp(-.5 * (off_nose * off_nose + off_mouth * off_mouth + off_level * off_level));
    std::vector<double> cheeks;
    for (const double x : {-.5, .5}) {
        const Window cheek = frame.window(x, .65, .1, .1);
        cheeks.insert(cheeks.end(), cheek.data(), cheek.data() + cheek.size());
    }
    const double skin = median(cheeks) + 1;
    const double nose = frame.midway("ala");
    const Window mouth = frame.window(nose, 1.15, .4, .3);
    const double contrast = deviation(mouth.middleCols(3, 35).eval());
    double edges = 0;
    for (int row = 3; row < mouth.rows(); row += 3) {
        edges += (mouth.row(row) - mouth.row(row - 3)).abs().sum();
    }
    edges /= 13. * 41;
    const double fold = std::max(deviation(frame.window(nose - .5, .95, .12, .15)),
                                 deviation(frame.window(nose + .5, .95, .12, .15)));
    double pupils = 0;
    for (const char* name : {"pupil.L", "pupil.R"}) {
        const Eigen::Vector2d at = frame.place(name);
        pupils += frame.window(at.x(), at.y(), .07, .07).mean() / 2;
    }
    return {frontal, contrast / skin, edges / skin, fold / skin, pupils / skin};
}

Eigen::VectorXd rest_scores(const std::vector<RestSigns>& frames) {
    if (frames.empty()) {
        return {};
    }
    const double sharpened = sharpening(frames);
    const AtRest pupils = open_pupils(frames);
    Eigen::VectorXd scores(static_cast<Eigen::Index>(frames.size()));
    std::transform(frames.begin(), frames.end(), scores.begin(), [&](const RestSigns& signs) {
        double score = signs.frontal * beyond(signs.pupil_brightness, pupils);
        for (const AtRest& contrast : kContrasts) {
            score *= beyond(signs.*contrast.sign / sharpened, contrast);
        }
        return score;
    });
    return scores;
}

double face_detail(ColorView image, const FaceFeatures& face) {
    std::array<int, 4> box{};
    for (int i = 0; i < 4; ++i) {
        box[static_cast<std::size_t>(i)] = static_cast<int>(std::nearbyint(face.box[i]));
    }
    const auto [left, top, width, height] = box;
    const int first_x = std::max(0, left), end_x = std::min(image.cols, left + width);
    const int first_y = std::max(0, top), end_y = std::min(image.rows, top + height);
    std::vector<double> bends;
    for (int y = first_y; y < end_y; ++y) {
        for (int x = first_x + 2; x < end_x; ++x) {
            bends.push_back(
                std::abs(grey_at(image, x, y) - 2 * grey_at(image, x - 1, y) + grey_at(image, x - 2, y)));
        }
    }
    std::sort(bends.begin(), bends.end());
    const auto count = static_cast<std::ptrdiff_t>(kSmooth * static_cast<double>(bends.size()));
    return count > 0 ? std::accumulate(bends.begin(), bends.begin() + count, 0.) / static_cast<double>(count)
                     : 0;
}

Expression expression_of(const FaceFeatures& face) {
    const Eigen::Vector2d right_eye = place_of(face, "pupil.R"), left_eye = place_of(face, "pupil.L");
    const Eigen::Vector2d middle = (right_eye + left_eye) / 2, across = left_eye - right_eye;
    const Eigen::Vector2d down(-across.y(), across.x());
    const auto height = [&](const std::string& name) {
        std::vector<double> heights;
        if (const FeatureCurve* curve = face.find_curve(name)) {
            for (Eigen::Index i = 0; i < curve->points.rows(); ++i) {
                heights.push_back((curve->points.row(i).transpose() - middle).dot(down));
            }
        }
        return median(heights);
    };
    const Eigen::Vector2d left = place_of(face, "mouth_corner.L"), right = place_of(face, "mouth_corner.R");
    Expression values;
    values << height("brow.L"), height("brow.R"), (left - middle).dot(down), (right - middle).dot(down),
        (place_of(face, "lip_lower") - place_of(face, "lip_upper")).dot(down), (left - right).dot(across);
    return values / across.squaredNorm();
}

Eigen::VectorXd usual_expression(const Expressions& expressions, VectorIn scores,
                                 std::optional<Eigen::Index> rest) {
    check_sizes(expressions, scores);
    if (rest) {
        check_frame(expressions, *rest);
    }
    const std::vector<int> frames = informative_frames(scores);
    Eigen::ArrayXd farthest = Eigen::ArrayXd::Zero(scores.size());
    for (const auto values : expressions.colwise()) {
        std::vector<double> known;
        for (const int f : frames) {
            if (!std::isnan(values[f])) {
                known.push_back(values[f]);
            }
        }
        const double usual = median(known);
        const double at_rest = rest && !std::isnan(values[*rest]) ? values[*rest] : usual;
        std::vector<double> distances;
        distances.reserve(frames.size());
        for (const int f : frames) {
            distances.push_back(std::isnan(values[f]) ? 0 : std::abs(values[f] - usual));
        }
        Eigen::ArrayXd off = (values.array() - at_rest).abs();
        off = off.isNaN().select(0, off);
        farthest = farthest.max(off / std::max(1.48 * median(distances), kLeastSpread));
    }
    return (-.5 * (farthest / kUsual).square()).exp();
}

Eigen::Index num_alike(const Expressions& expressions, Eigen::Index frame) {
    check_frame(expressions, frame);
    return alike(expressions, frame).count();
}

std::vector<int> distinct_first(VectorIn chances, const Expressions& expressions) {
    check_sizes(expressions, chances);
    std::vector<int> order(static_cast<std::size_t>(chances.size()));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return chances[a] > chances[b]; });
    Eigen::ArrayX<bool> is_shown = Eigen::ArrayX<bool>::Constant(chances.size(), false);
    std::vector<int> distinct, others;
    for (const int frame : order) {
        (is_shown[frame] ? others : distinct).push_back(frame);
        if (!is_shown[frame]) {
            is_shown = is_shown || alike(expressions, frame);
        }
    }
    distinct.insert(distinct.end(), others.begin(), others.end());
    return distinct;
}

Eigen::VectorXd shared_expression(const Expressions& expressions, VectorIn weights) {
    check_sizes(expressions, weights);
    Eigen::VectorXd number = Eigen::VectorXd::Zero(weights.size());
    for (Eigen::Index a = 0; a < weights.size(); ++a) {
        number[a] = weights.dot((-away_from(expressions, a).square()).exp().matrix());
    }
    return number / std::max(number.maxCoeff(), 1e-300);
}

Eigen::VectorXd chances_of_rest(VectorIn scores, VectorIn details, const Expressions& expressions) {
    check_sizes(expressions, scores);
    check_sizes(expressions, details);
    const Eigen::ArrayXd weights = scores.array() * shares_of_detail(details).square();
    return weights * usual_expression(expressions, scores).array() *
           shared_expression(expressions, weights.matrix()).array();
}

Eigen::VectorXd costs_of_rest(MatrixIn values, MatrixIn lids, VectorIn scores, VectorIn details,
                              MatrixIn covered_lids) {
    if (values.rows() == 0 || lids.rows() != values.rows() || scores.size() != values.rows() ||
        details.size() != values.rows() || covered_lids.cols() != lids.cols()) {
        throw InvalidInput("there must be values, lids, a score and a detail for each of some frames");
    }
    Eigen::VectorXd excess = Eigen::VectorXd::Zero(values.rows());
    for (const auto value : values.colwise()) {
        const double relaxed = quantile({value.begin(), value.end()}, kRelaxed);
        excess += kPerExcess * (value.array() - relaxed).max(0).matrix();
    }
    for (Eigen::Index i = 0; i < lids.cols(); ++i) {
        std::vector<double> seen(lids.col(i).begin(), lids.col(i).end());
        seen.insert(seen.end(), covered_lids.col(i).begin(), covered_lids.col(i).end());
        const double open = quantile(seen, kOpenLid);
        excess += kPerLid * (lids.col(i).array() - open - kLidAtRest).max(0).matrix();
    }
    Eigen::VectorXd density(values.rows());
    for (Eigen::Index frame = 0; frame < values.rows(); ++frame) {
        const Eigen::ArrayXd away = (values.rowwise() - values.row(frame)).rowwise().squaredNorm();
        density[frame] = (-away / (2 * kSameState * kSameState)).exp().sum();
    }
    return excess.array() - density.array().log() - kPerScore * scores.array().max(kLeastShare).log() -
           kPerDetail * shares_of_detail(details).max(kLeastShare).log();
}

}  // namespace mimetic
