// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mimetic/locate/locate.hpp>
#include <mimetic/locate/occlusion.hpp>
#include <mimetic/locate/well_lit.hpp>
#include <mimetic/shared/error.hpp>
#include <mutex>

#include "crop_picture.hpp"
#include "network_file.hpp"

namespace mimetic {
namespace {

// As `scripts/build/occlusion/pictures.py` has them
constexpr int kSide = 96;
const Eigen::Vector3d kMiddle(0, -.0014, .08);  // head frame, metres
constexpr double kLength = .19;                 // metres
// Half the width and height of a face in its square, and how far below its middle that of the face is; sides
constexpr double kFaceAcross = .31, kFaceAlong = .4, kFaceDown = .02;

}  // namespace

double Occlusion::at(const Eigen::Vector2d& pixel) const {
    if (cells.size() == 0) return 0;
    const Eigen::Vector2d share = locate::in_crop(pixel, square);
    const double x = share.x() * static_cast<double>(cells.cols()) - .5;
    const double y = share.y() * static_cast<double>(cells.rows()) - .5;
    const auto right = static_cast<double>(cells.cols() - 1), bottom = static_cast<double>(cells.rows() - 1);
    if (!(x >= -.5 && y >= -.5 && x <= right + .5 && y <= bottom + .5)) return 0;
    const double column = std::clamp(x, 0., right), row = std::clamp(y, 0., bottom);
    const auto i = static_cast<Eigen::Index>(std::min(row, bottom - 1)),
               j = static_cast<Eigen::Index>(std::min(column, right - 1));
    const double down = row - static_cast<double>(i), along = column - static_cast<double>(j);
    return (1 - down) * ((1 - along) * cells(i, j) + along * cells(i, j + 1)) +
           down * ((1 - along) * cells(i + 1, j) + along * cells(i + 1, j + 1));
}

Eigen::Vector2d Occlusion::pixel_of(double row, double column) const {
    const Eigen::RowVector2d share((column + .5) / static_cast<double>(cells.cols()),
                                   (row + .5) / static_cast<double>(cells.rows()));
    return locate::in_picture(share, square, false).row(0);
}

double Occlusion::share(double probability) const {
    double hidden = 0, of_face = 0;
    for (Eigen::Index row = 0; row < cells.rows(); ++row) {
        for (Eigen::Index column = 0; column < cells.cols(); ++column) {
            const double x = (static_cast<double>(column) + .5) / static_cast<double>(cells.cols());
            const double y = (static_cast<double>(row) + .5) / static_cast<double>(cells.rows());
            if (outward_of_face({x, y}) < 1) {
                of_face += 1;
                hidden += cells(row, column) > probability;
            }
        }
    }
    return of_face > 0 ? hidden / of_face : 0;
}

double outward_of_face(const Eigen::Vector2d& share) {
    return std::hypot((share.x() - .5) / kFaceAcross, (share.y() - .5 - kFaceDown) / kFaceAlong);
}

FeatureCrop occlusion_square(const Camera& camera, const Eigen::Isometry3d& camera_from_head) {
    return crop_round(camera, camera_from_head, kMiddle, kLength);
}

FeatureCrop occlusion_square(const FaceFeatures& face) {
    // Of the crop about a face: medians of frames of five clips and of 19 photographs, between which they
    // vary by .08 and .02
    constexpr double kSide = .79, kDown = .053;
    FeatureCrop square = crop_about(face);
    square.side *= kSide;
    square.center += kDown * square.side * Eigen::Vector2d(-std::sin(square.roll), std::cos(square.roll));
    return square;
}

struct OcclusionNetwork::Net {
    std::mutex busy;
    cv::dnn::Net net;
};

OcclusionNetwork::OcclusionNetwork(const std::string& file) : net_(std::make_unique<Net>()) {
    try {
        net_->net = locate::load_network(file, {3, kSide, kSide}, {std::size_t{kCells} * kCells});
    } catch (const UnreadableMedia&) {  // it is part of the package, not of what set-up fetches
        throw UnreadableMedia(file + ": missing or damaged; install Mimetic again");
    }
}

OcclusionNetwork::~OcclusionNetwork() = default;
OcclusionNetwork::OcclusionNetwork(OcclusionNetwork&&) noexcept = default;
OcclusionNetwork& OcclusionNetwork::operator=(OcclusionNetwork&&) noexcept = default;

Occlusion OcclusionNetwork::see(ColorView image, const FeatureCrop& square) const {
    check_image_size(image.rows, image.cols, "image");
    square.check();
    Occlusion seen{square, {}};
    const cv::Mat blob = locate::standardised(locate::blob_of(image, seen.square, kSide, false));
    const std::lock_guard lock(net_->busy);
    const cv::Mat logits = locate::outputs_of(net_->net, blob)[0];
    const Eigen::Map<const Rows<float, kCells>> cells(logits.ptr<float>(), kCells, kCells);
    seen.cells = cells.unaryExpr([](float logit) { return 1 / (1 + std::exp(-logit)); });
    return seen;
}

}  // namespace mimetic
