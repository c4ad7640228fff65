// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <mimetic/analyse/measured_courses.hpp>
#include <mimetic/shared/types.hpp>
#include <optional>
#include <vector>

namespace mimetic {

/// How an actuation rises and falls, from few parameters to many.
enum class PhaseModel {
    linear_ramp,      ///< straight up, straight down: what FACS animations use
    one_exponential,  ///< A (e^(k s) - 1) / (e^k - 1) up, A e^(-t / tau) down
    two_exponentials  ///< down by a release and a slower relaxation
};
inline constexpr int kNumPhaseModels = 3;

/// One application, hold, release and relaxation. Times in frames on the curve's own frame numbers.
struct PhaseShape {
    PhaseModel model = PhaseModel::one_exponential;
    double rest = 0;  ///< before it and after it
    /// Level that it is applied from, where that is well above rest: half relaxed after another event. Else
    /// it is applied from rest.
    std::optional<double> before;
    double amplitude = 0;     ///< above rest, where the application ends
    double onset = 0;         ///< application begins
    double rise = 1;          ///< frames of the application
    double hold = 0;          ///< frames from its end to the release
    double drift = 0;         ///< share by which the level changes from there to the release, in a long hold
    double exponent = 0;      ///< k: above 0 the application speeds up, below 0 it slows down, 0 is straight
    double release_time = 1;  ///< tau of the release; of a linear ramp the frames it falls
    double relaxation_time = 0;  ///< tau of the relaxation; 0 without one
    double relaxed_share = 0;    ///< of the amplitude that relaxes, 0 without one
    double climb() const { return rest + amplitude - before.value_or(rest); }  ///< of the application
    double apex() const { return onset + rise; }
    double release() const { return onset + rise + hold; }
    double fall_time() const;  ///< frames from the release until a tenth of the height there is left
    double value(double frame) const;
};

/// An estimate with its 95 % interval.
struct Interval {
    double value = 0, lower = 0, upper = 0;
};

/// An event of a curve with its phases.
struct PhaseFit {
    PhaseShape shape;
    Interval onset, apex, release, amplitude, exponent, release_time, relaxation_time, relaxed_share;
    Interval length;                            ///< frames from the onset to the end of `fall_time`
    std::array<double, kNumPhaseModels> bic{};  ///< of each model; the shape's is the least
    double noise = 0;                           ///< s.d. of the curve about the fit
    double smoothing = 0;                       ///< ratio of CurveNoise
    double shape_std = 0;                       ///< of the logarithm of the power that may distort the shape
    double explained = 0;                       ///< R2 about the mean
    double linear_explained = 0;                ///< R2 of the best linear ramp
    int first = 0, last = 0;                    ///< rows of the curve that were fitted
    bool begins_before = false;  ///< active when the clip begins: onset and exponent are not known
    bool ends_after = false;     ///< active when the clip ends: release and relaxation are not known
    bool is_certain = false;     ///< its amplitude is significant against the curve's own error
};

struct PhaseOptions {
    double least_amplitude = .05;  ///< of an event
    double least_drop = .35;       ///< of its height that the curve must fall by between two events
    double certainty = 1.64;       ///< standard deviations of a certain event's amplitude
    double robust_scale = .05;     ///< of soft L1
    double timing_std = .5;        ///< frames: s.d. of a capture's timing, beside the curve's noise
    double measured_std = 0;       ///< of what was smoothed, where a curve is a mean of several; 0: its own
    double exponent_std = 0;       ///< s.d. of exponents about 0, beforehand; 0: anything is as likely
    double shape_error = 0;        ///< s.d. of the logarithm of the power by which an event's shape may be
                                   ///< distorted, as a multiple of its value's s.d. over its amplitude
    int num_draws = 100;           ///< of the parametric bootstrap, 0 to 10000
    unsigned seed = 1;
    std::vector<double> scene_starts;  ///< frames at which scenes begin: no event goes over one
    void check() const;                ///< throws InvalidInput: field, value, limit
};

/// The muscles whose mean a curve is, and what the pictures say about them.
struct MeasuredGroup {
    const MeasuredCourses* courses = nullptr;
    Eigen::VectorXd members;  ///< as `MeasuredCourses::course` has them
};

/// Events of a curve, in order. frames, values, stds: N, frames rising; usable: N, false where a frame is
/// held and carries no information. stds are of each value, most of it error that stays the same from frame
/// to frame: it counts against the amplitude, while the times' intervals come from the curve's own noise
/// about the fit. Models are fitted through what the smoother does to a curve; where `measured` is given, to
/// what the pictures say about each event instead. Throws InvalidInput on other lengths.
std::vector<PhaseFit> fit_phases(VectorIn frames, VectorIn values, VectorIn stds,
                                 const std::vector<bool>& usable, const PhaseOptions& options = {},
                                 const MeasuredGroup& measured = {});

/// Parametric bootstrap draws of the fitted curve: rows first to last, a column a draw.
Eigen::MatrixXd draw_curves(const PhaseFit& fit, VectorIn frames, int num_draws, unsigned seed);

}  // namespace mimetic
