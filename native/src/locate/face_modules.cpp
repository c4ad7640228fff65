// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <mimetic/error.hpp>
#include <opencv2/imgproc.hpp>

#include "locate/likelihood.hpp"

namespace mimetic {
namespace {

constexpr int kMostModules = 6;
constexpr double kReach = 3;  // deviations

struct Candidate {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< from the face's centre, in its widths, upright
    double log_likelihood = 0;
};

void need(bool holds, const std::string& what) {
    if (!holds) throw InvalidInput("modules of the face: " + what);
}

void check(const std::vector<FaceModule>& modules, MatrixIn covariance, const SpaceMatch& face,
           int candidates) {
    const auto count = static_cast<Eigen::Index>(modules.size());
    need(count >= 1 && count <= kMostModules,
         std::to_string(count) + " were given; 1 to " + std::to_string(kMostModules) + " can be placed");
    need(covariance.rows() == 2 * count && covariance.cols() == 2 * count && covariance.allFinite(),
         "the covariance must be finite, " + std::to_string(2 * count) + " square");
    need(candidates >= 1 && candidates <= 8, "candidates must be 1 to 8");
    need(face.center.allFinite() && face.width >= 4, "the face must be finite and at least 4 pixels wide");
    for (const auto& module : modules) {
        module.space.check();
        need(module.width > 0.01 && module.width <= 2 && module.place.allFinite(),
             module.name + " has a width outside 0.01 to 2 or no place");
    }
}

Eigen::Rotation2Dd image_from_upright(const SpaceMatch& face) { return Eigen::Rotation2Dd(face.roll); }

std::vector<Candidate> candidates_of(const FaceModule& module, const Eigen::Vector2d& deviation,
                                     const cv::Mat1f& image, const SpaceMatch& face, int count) {
    const double px = module.space.width / module.width;  // window pixels a width of the face
    const Eigen::Array2d reach = kReach * deviation.array() * px;
    const cv::Size size(module.space.width + 2 * static_cast<int>(std::ceil(reach.x())),
                        module.space.height + 2 * static_cast<int>(std::ceil(reach.y())));
    need(size.area() < 4 << 20, module.name + " would be sought over too wide a window");
    // Window pixel -> image: turned, scaled, its middle on the module's mean place
    const Eigen::Matrix2d turn = image_from_upright(face).toRotationMatrix() * (face.width / px);
    const Eigen::Vector2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
    const Eigen::Vector2d shift =
        face.center + image_from_upright(face) * (face.width * module.place) - turn * middle;
    const cv::Matx23d warp(turn(0, 0), turn(0, 1), shift.x(), turn(1, 0), turn(1, 1), shift.y());
    cv::Mat1f source = image, window;
    // warpAffine reads four pixels: a shrunken image has to be smoothed first
    if (face.width / px > 1.5) cv::GaussianBlur(image, source, {}, 0.4 * face.width / px);
    cv::warpAffine(source, window, warp, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    const cv::Mat1f map = locate::likelihoods(module.space, window, 0.5);
    const Eigen::Vector2d half(0.5 * (module.space.width - 1), 0.5 * (module.space.height - 1));
    std::vector<Candidate> found;
    for (const auto& summit : locate::summits(map, count, 2))
        found.push_back({module.place + (summit.head<2>() + half - middle) / px, summit.z()});
    if (found.empty()) found.push_back({module.place, -std::numeric_limits<double>::infinity()});
    return found;
}

}  // namespace

ModulePlaces place_modules(const std::vector<FaceModule>& modules, MatrixIn covariance, GrayView image,
                           const SpaceMatch& face, int candidates) {
    check(modules, covariance, face, candidates);
    check_image_size(image.rows, image.cols, "image");
    const Eigen::LLT<Eigen::MatrixXd> factor((Eigen::MatrixXd(covariance)));
    need(factor.info() == Eigen::Success, "the covariance is not positive definite");
    const cv::Mat bytes(image.rows, image.cols, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    cv::Mat1f gray;
    bytes.convertTo(gray, CV_32F);

    const std::size_t count = modules.size();
    std::vector<std::vector<Candidate>> sought;
    for (std::size_t i = 0; i < count; ++i) {
        const auto at = static_cast<Eigen::Index>(2 * i);
        const Eigen::Vector2d deviation = covariance.diagonal().segment<2>(at).cwiseSqrt();
        sought.push_back(candidates_of(modules[i], deviation, gray, face, candidates));
    }
    std::vector<std::size_t> choice(count, 0), best;
    double highest = -std::numeric_limits<double>::infinity(), prior = 0;
    for (;;) {
        Eigen::VectorXd off(2 * static_cast<Eigen::Index>(count));
        double total = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Candidate& candidate = sought[i][choice[i]];
            off.segment<2>(static_cast<Eigen::Index>(2 * i)) = candidate.place - modules[i].place;
            if (std::isfinite(candidate.log_likelihood)) total += candidate.log_likelihood;
        }
        const double here = factor.matrixL().solve(off).squaredNorm();
        if (best.empty() || total - 0.5 * here > highest) {
            best = choice;
            highest = total - 0.5 * here;
            prior = here;
        }
        std::size_t digit = 0;
        while (digit < count && ++choice[digit] == sought[digit].size()) choice[digit++] = 0;
        if (digit == count) break;
    }
    ModulePlaces places{Points2(static_cast<Eigen::Index>(count), 2),
                        Eigen::VectorXd(static_cast<Eigen::Index>(count)), prior};
    for (std::size_t i = 0; i < count; ++i) {
        const Candidate& candidate = sought[i][best[i]];
        places.positions.row(static_cast<Eigen::Index>(i)) =
            face.center + image_from_upright(face) * (face.width * candidate.place);
        places.log_likelihood(static_cast<Eigen::Index>(i)) = candidate.log_likelihood;
    }
    return places;
}

}  // namespace mimetic
