// SPDX-License-Identifier: GPL-3.0-or-later
// What the operators of its own do in MediaPipe's mesh with attention: Landmarks2TransformMatrix,
// TransformTensorBilinear and TransformLandmarks in their second version, as mediapipe/util/tflite/operations
// has them; the points of each part are those of the network's file.
#include "attention.hpp"

#include <cmath>

#include "shared/bilinear.hpp"

namespace mimetic::locate {
namespace {

constexpr double kMargin = 1.5;   // of a part's box
constexpr int kCells = 16;        // of the square that a head reads, along a side
constexpr double kSaidSide = 64;  // of the square in whose pixels it answers

constexpr std::array kLips{61,  146, 91,  181, 84,  17,  314, 405, 321, 375, 291, 185, 40,  39,  37,  0,
                           267, 269, 270, 409, 78,  95,  88,  178, 87,  14,  317, 402, 318, 324, 308, 191,
                           80,  81,  82,  13,  312, 311, 310, 415, 76,  77,  90,  180, 85,  16,  315, 404,
                           320, 307, 306, 184, 74,  73,  72,  11,  302, 303, 304, 408, 62,  96,  89,  179,
                           86,  15,  316, 403, 319, 325, 292, 183, 42,  41,  38,  12,  268, 271, 272, 407};
constexpr std::array kRightEye{33,  7,   163, 144, 145, 153, 154, 155, 133, 246, 161, 160, 159, 158, 157,
                               173, 130, 25,  110, 24,  23,  22,  26,  112, 243, 247, 30,  29,  27,  28,
                               56,  190, 226, 31,  228, 229, 230, 231, 232, 233, 244, 113, 225, 224, 223,
                               222, 221, 189, 35,  124, 46,  53,  52,  65,  143, 111, 117, 118, 119, 120,
                               121, 128, 245, 156, 70,  63,  105, 66,  107, 55,  193};
constexpr std::array kLeftEye{263, 249, 390, 373, 374, 380, 381, 382, 362, 466, 388, 387, 386, 385, 384,
                              398, 359, 255, 339, 254, 253, 252, 256, 341, 463, 467, 260, 259, 257, 258,
                              286, 414, 446, 261, 448, 449, 450, 451, 452, 453, 464, 342, 445, 444, 443,
                              442, 441, 413, 265, 353, 276, 283, 282, 295, 372, 340, 346, 347, 348, 349,
                              350, 357, 465, 383, 300, 293, 334, 296, 336, 285, 417};

}  // namespace

const AttentionPart kLipsPart{kLips, 61, 291};
const std::array<AttentionPart, 2> kEyeParts{AttentionPart{kLeftEye, 362, 263},
                                             AttentionPart{kRightEye, 33, 133}};

PartSquare square_of(const AttentionPart& part, const Points2& mesh) {
    const Eigen::RowVector2d level = mesh.row(part.right) - mesh.row(part.left);
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(std::atan2(level.y(), level.x())).toRotationMatrix();
    Eigen::RowVector2d least = mesh.row(part.points[0]) * turn, most = least;
    for (const int point : part.points) {
        const Eigen::RowVector2d turned = mesh.row(point) * turn;
        least = least.cwiseMin(turned);
        most = most.cwiseMax(turned);
    }
    PartSquare square;
    square.leftCols<2>() = turn * (kMargin * (most - least)).asDiagonal();
    square.col(2) =
        turn * (0.5 * (least + most)).transpose() - square.leftCols<2>() * Eigen::Vector2d::Constant(0.5);
    return square;
}

cv::Mat seen_in(const cv::Mat& maps, const PartSquare& square) {
    const int channels = maps.size[1], rows = maps.size[2], cols = maps.size[3];
    const int shape[] = {1, channels, kCells, kCells};
    cv::Mat seen(4, shape, CV_32F, cv::Scalar(0));
    for (int i = 0; i < kCells * kCells; ++i) {
        const Eigen::Vector3d cell((i % kCells + 0.5) / kCells, (i / kCells + 0.5) / kCells, 1);
        const Eigen::Vector2d share = square * cell;
        const double x = share.x() * cols - 0.5, y = share.y() * rows - 0.5;
        if (!(x >= 0 && x < cols - 1 && y >= 0 && y < rows - 1)) continue;
        for (int channel = 0; channel < channels; ++channel) {
            const cv::Mat1f map(rows, cols, const_cast<float*>(maps.ptr<float>(0, channel)));
            seen.ptr<float>(0, channel)[i] = bilinear(map, static_cast<float>(x), static_cast<float>(y));
        }
    }
    return seen;
}

Points2 points_of(const cv::Mat& output, const PartSquare& square) {
    const float* values = output.ptr<float>();
    Points2 points(static_cast<Eigen::Index>(output.total() / 2), 2);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const Eigen::Vector3d said(values[2 * i] / kSaidSide, values[2 * i + 1] / kSaidSide, 1);
        points.row(i) = (square * said).transpose();
    }
    return points;
}

}  // namespace mimetic::locate
