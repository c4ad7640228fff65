// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mimetic/analyse/measured_courses.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/solve/stored_evidence.hpp>

namespace mimetic {
namespace {

constexpr int kPose = 6;
constexpr int kAboutTop = 2;       // rows before and after whose proportions are taken
constexpr double kOtherStd = .06;  // of other values about what was captured
constexpr double kWidePose = 30;   // rad, metres: the pictures alone say where the head is
constexpr double kLeastSum = 1e-9;

}  // namespace

MeasuredCourses::MeasuredCourses(MatrixIn activations,
                                 const Eigen::Ref<const Rows<float, Eigen::Dynamic>>& evidence)
    : activations_(activations), evidence_(evidence), size_(evidence_state_size(evidence.cols())) {
    require(evidence.rows() == activations.rows() && size_ >= kPose + activations.cols(),
            "MeasuredCourses: the evidence is not of these frames and muscles");
    require(activations.allFinite() && evidence.allFinite(),
            "MeasuredCourses: activations or evidence are not finite");
}

Eigen::VectorXd MeasuredCourses::course(VectorIn members, int first, int last, int top) const {
    require(members.size() == activations_.cols(), "MeasuredCourses: one number for each muscle is wanted");
    require(0 <= first && first <= top && top <= last && last < num_frames(),
            "MeasuredCourses: rows are not of these frames");
    const int begin = std::max(first, top - kAboutTop), end = std::min(last, top + kAboutTop);
    const Eigen::VectorXd mean = activations_.middleRows(begin, end - begin + 1).colwise().mean();
    const Eigen::VectorXd shown = mean.cwiseProduct(members);
    const double count = std::max(1., members.sum());
    Eigen::VectorXd course = activations_.middleRows(first, last - first + 1) * members / count;
    if (shown.sum() < kLeastSum) {
        return course;
    }
    const Eigen::VectorXd pattern = shown * (count / shown.sum());
    std::vector<int> others;
    for (int i = 0; i < size_; ++i) {
        const int muscle = i - kPose;
        if (muscle < 0 || muscle >= num_muscles() || members[muscle] <= 0) {
            others.push_back(i);
        }
    }
    for (int row = first; row <= last; ++row) {
        if ((evidence_.row(row).array() != 0).any()) {
            course[row - first] = measured_mean(pattern, others, row);
        }
    }
    return course;
}

/// The step of pose and other values, and the pattern's height, that agree best with the row's evidence.
double MeasuredCourses::measured_mean(const Eigen::VectorXd& pattern, const std::vector<int>& others,
                                      int row) const {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(size_ - kPose);
    const FrameEstimate seen = stored_estimate(Eigen::Isometry3d::Identity(), Matrix6::Identity(), none, none,
                                               evidence_.row(row), 1, false);
    const Eigen::Index num_others = std::ssize(others);
    Eigen::MatrixXd steps = Eigen::MatrixXd::Zero(size_, num_others + 1);
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(num_others + 1), back = Eigen::VectorXd::Zero(size_);
    for (Eigen::Index i = 0; i < num_others; ++i) {
        const int at = others[static_cast<std::size_t>(i)];
        steps(at, i) = 1;
        prior[i] = std::pow(at < kPose ? kWidePose : kOtherStd, -2);
    }
    for (int muscle = 0; muscle < num_muscles(); ++muscle) {
        steps(kPose + muscle, num_others) = pattern[muscle];
        back[kPose + muscle] = -activations_(row, muscle);
    }
    for (const int at : others) {
        back[at] = 0;
    }
    Eigen::MatrixXd system = steps.transpose() * seen.information * steps;
    system.diagonal() += prior;
    const Eigen::VectorXd pull = steps.transpose() * (seen.gradient - seen.information * back);
    return system.ldlt().solve(pull)[num_others];
}

}  // namespace mimetic
