// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/skin/skin.hpp>

namespace mimetic {

/// Mass of the skin for the unknowns of its model (linear shape functions): 3C x 3C, kg. surface_density: N,
/// kg/m^2, the skin and what moves with it. Throws InvalidInput on a mesh that is not the model's and on
/// densities that are not positive.
Eigen::SparseMatrix<double> skin_mass(const SkinModel& model, PointsIn vertices, TrianglesIn triangles,
                                      VectorIn surface_density);

enum class TimeScheme {
    newmark,         ///< beta 1/4, gamma 1/2: second order, conserves energy without damping
    backward_euler,  ///< first order, damps what the step cannot resolve
};

/// M u'' + D u' + K (u + p) = f. D is Rayleigh's damping; p is the internal variable of a standard linear
/// solid (spring beside a Maxwell element), p' + p / tau = share u', so that skin held at a place pulls
/// 1 + share times as hard at first and relaxes to the static K.
struct DynamicsOptions {
    TimeScheme scheme = TimeScheme::newmark;
    double step = 1.0 / 240;       ///< s
    double mass_damping = 0;       ///< alpha of D = alpha M + beta K, 1/s
    double stiffness_damping = 0;  ///< beta, s
    double relaxation_share = 0;   ///< E_1 / E_inf
    double relaxation_time = 0.5;  ///< tau, s

    void check() const;  ///< throws InvalidInput: field, value, limit
};

/// Where the skin is and how it moves, unknowns in the order of SkinModel.
struct DynamicState {
    Eigen::VectorXd displacement;  ///< m
    Eigen::VectorXd velocity;      ///< m/s
    Eigen::VectorXd acceleration;  ///< m/s^2
    Eigen::VectorXd overstrain;    ///< p, m: K p is the viscoelastic force
};

/// Implicit steps in time of the whole model. The matrix of a step is factored once.
class SkinDynamics {
public:
    /// stiffness, mass: 3C x 3C, N/m and kg, symmetric. At rest and relaxed until `start`. Throws
    /// InvalidInput on shapes that differ and on matrices that are not positive definite.
    SkinDynamics(const Eigen::SparseMatrix<double>& stiffness, const Eigen::SparseMatrix<double>& mass,
                 const DynamicsOptions& options = {});
    ~SkinDynamics();
    SkinDynamics(SkinDynamics&&) noexcept;
    SkinDynamics& operator=(SkinDynamics&&) noexcept;
    SkinDynamics(const SkinDynamics&) = delete;
    SkinDynamics& operator=(const SkinDynamics&) = delete;

    /// From this displacement and velocity, relaxed, under this load: sizes 3C.
    void start(VectorIn displacement, VectorIn velocity, VectorIn load);
    /// One step; `load` (3C, newtons) acts at its end, and before it changed linearly.
    const DynamicState& advance(VectorIn load);

    const DynamicState& state() const;
    /// Kinetic and elastic energy without what the overstrain holds, J.
    double energy() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// Natural modes of K phi = omega^2 M phi, lowest first.
struct VibrationModes {
    Eigen::VectorXd frequencies;  ///< Hz
    Eigen::MatrixXd shapes;       ///< 3C x M, columns with phi^T M phi = 1
};

/// The `num_modes` lowest modes, by Lanczos iterations with the inverse of the stiffness (Spectra). Throws
/// InvalidInput on a singular stiffness and on more modes than unknowns less one.
VibrationModes vibration_modes(const Eigen::SparseMatrix<double>& stiffness,
                               const Eigen::SparseMatrix<double>& mass, int num_modes);

/// The same equation within the span of static responses and natural modes, in decoupled
/// coordinates. Slow motion is exact (the responses), the lowest modes carry what inertia adds: the Galerkin
/// form of mode acceleration.
class ReducedSkin {
public:
    /// loads: 3C x L, newtons, a column for each muscle or motion of a bone at value 1; num_modes may be 0.
    ReducedSkin(const Eigen::SparseMatrix<double>& stiffness, const Eigen::SparseMatrix<double>& mass,
                const Eigen::Ref<const Eigen::MatrixXd>& loads, int num_modes,
                const DynamicsOptions& options = {});

    int num_values() const { return static_cast<int>(load_.cols()); }         ///< L
    int num_coordinates() const { return static_cast<int>(shapes_.cols()); }  ///< R <= L + num_modes
    const Eigen::MatrixXd& shapes() const { return shapes_; }            ///< 3C x R, unknowns of coordinates
    const Eigen::VectorXd& frequencies() const { return frequencies_; }  ///< R, Hz, undamped

    void reset();  ///< at rest and relaxed
    /// One step to the L values at its end: R coordinates.
    const Eigen::VectorXd& advance(VectorIn values);
    const Eigen::VectorXd& coordinates() const { return displacement_; }

private:
    DynamicsOptions options_;
    Eigen::MatrixXd shapes_;
    Eigen::MatrixXd load_;  // R x L
    Eigen::VectorXd frequencies_;
    Eigen::ArrayXd stiffness_;  // omega^2; masses are 1
    Eigen::ArrayXd compliance_;
    Eigen::VectorXd displacement_;
    Eigen::ArrayXd velocity_, acceleration_, overstrain_;
    Eigen::ArrayXd increment_;  // kept, so that a step allocates nothing
};

/// Displacements of places on the surface from reduced coordinates: stencils times shapes, folded once into
/// one dense matrix of single precision.
class ReducedSurface {
public:
    /// stencils: P x C, a row a place, for unknowns in the order of SkinModel; shapes: 3C x R.
    ReducedSurface(const SparseRows& stencils, const Eigen::Ref<const Eigen::MatrixXd>& shapes);

    int num_places() const { return static_cast<int>(field_.rows() / 3); }
    /// P x 3, metres, for R coordinates.
    const Rows<float, 3>& displacements(VectorIn coordinates);

private:
    Eigen::MatrixXf field_;  // 3P x R
    Eigen::VectorXf coordinates_;
    Rows<float, 3> displacements_;
};

}  // namespace mimetic
