// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/raster/shaded.hpp>
#include <mimetic/register/deformable_template.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/nearest.hpp>
#include <mimetic/surface/skin_places.hpp>

namespace mimetic {

// Chosen on the tuning heads of `evaluation/synthetic/characters.py`, half of them bent by smooth random
// fields that no identity makes
namespace {

constexpr Eigen::Index kNumBumps = 60;
constexpr double kBumpLength = .02, kBumpHeight = .002;  // m, of smooth departures from the identity space
constexpr int kRounds = 12;
constexpr double kFirstReach = .004, kLastReach = .0007;  // m, residuals that count half as much
constexpr double kPointSigma = .0021;   // m, of one vertex's distance: neighbours say the same again
constexpr double kLandmarkWeight = .5;  // of the targets' information: one view's errors are all views'
constexpr double kAlike = .5;           // cosine of normals of skin that is drawn to other skin
constexpr Eigen::Index kPose = 7;       // unknowns: rotation, logarithm of the scale, translation

/// Vertices far from each other: each next is the farthest from those before.
std::vector<int> spread_vertices(const Points& vertices, const std::vector<int>& among, Eigen::Index count) {
    std::vector<int> chosen;
    Eigen::VectorXd distances = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(among.size()),
                                                          std::numeric_limits<double>::infinity());
    Eigen::Index next = 0;
    while (static_cast<Eigen::Index>(chosen.size()) < count && distances[next] > 0) {
        chosen.push_back(among[static_cast<std::size_t>(next)]);
        const Eigen::RowVector3d place = vertices.row(chosen.back());
        distances = distances.cwiseMin((vertices(among, Eigen::all).rowwise() - place).rowwise().norm());
        distances.maxCoeff(&next);
    }
    return chosen;
}

Eigen::MatrixXd smooth_bumps(const Points& vertices, const std::vector<int>& centres) {
    Eigen::MatrixXd bumps(vertices.rows(), static_cast<Eigen::Index>(centres.size()));
    for (Eigen::Index b = 0; b < bumps.cols(); ++b) {
        const Eigen::RowVector3d centre = vertices.row(centres[static_cast<std::size_t>(b)]);
        const Eigen::ArrayXd squares = (vertices.rowwise() - centre).rowwise().squaredNorm();
        bumps.col(b) = kBumpHeight * (-squares / (2 * kBumpLength * kBumpLength)).exp();
    }
    return bumps;
}

}  // namespace

/// The mesh that a template is laid on.
class MeshSurface {
public:
    MeshSurface(PointsIn vertices, PointsIn normals, TrianglesIn triangles)
        : vertices_(vertices),
          normals_(normals),
          around_(triangles, static_cast<int>(vertices.rows())),
          nearest_(vertices_(around_.used(), Eigen::all)) {}

    SkinPlaces closest(const Points& points) const {
        Eigen::VectorXi near = nearest_.find(points);
        for (int& vertex : near) {
            vertex = around_.used()[static_cast<std::size_t>(vertex)];
        }
        return around_.closest(points, near, vertices_);
    }

    const Points& vertices() const { return vertices_; }
    const Points& normals() const { return normals_; }

private:
    Points vertices_, normals_;
    TrianglesAround around_;
    NearestPoints nearest_;
};

/// mesh = linear * (template + modes) + translation; linear: a rotation and a scale.
struct DeformableTemplate::State {
    Eigen::VectorXd modes, bumps;  ///< K, and 3B by axes, in standard deviations
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Eigen::RowVector3d translation = Eigen::RowVector3d::Zero();

    void step(const Eigen::VectorXd& by) {
        modes += by.head(modes.size());
        bumps += by.segment(modes.size(), bumps.size());
        const Eigen::Vector3d turn = by.tail(kPose).head<3>();
        const double angle = turn.norm();
        const Eigen::AngleAxisd rotation(
            angle, angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d(Eigen::Vector3d::UnitX()));
        linear = std::exp(by[by.size() - 4]) * rotation.toRotationMatrix() * linear;
        translation += by.tail<3>().transpose();
    }
};

DeformableTemplate::DeformableTemplate(PointsIn vertices, TrianglesIn triangles, MatrixIn modes,
                                       VectorIn sigma, const std::vector<bool>& is_face)
    : vertices_(vertices), triangles_(triangles) {
    require(modes.cols() == 3 * vertices.rows() && sigma.size() == modes.rows() &&
                is_face.size() == static_cast<std::size_t>(vertices.rows()),
            "modes need three columns a vertex and a standard deviation each, vertices a flag each");
    require(triangles.rows() > 0 && triangles.minCoeff() >= 0 && triangles.maxCoeff() < vertices.rows(),
            "the template has no triangle, or one that names a vertex it does not have");
    modes_ = sigma.asDiagonal() * modes;
    for (std::size_t v = 0; v < is_face.size(); ++v) {
        if (is_face[v]) {
            face_.push_back(static_cast<int>(v));
        }
    }
    require(!face_.empty(), "no vertex of the template is of its face");
    bumps_ = smooth_bumps(vertices_, spread_vertices(vertices_, face_, kNumBumps));
}

Eigen::Index DeformableTemplate::num_unknowns() const { return modes_.rows() + 3 * bumps_.cols() + kPose; }

Points DeformableTemplate::shape(const State& state) const {
    const Eigen::RowVectorXd moved = state.modes.transpose() * modes_;
    Points shape = vertices_ + Eigen::Map<const Points>(moved.data(), vertices_.rows(), 3);
    shape += bumps_ * state.bumps.reshaped(bumps_.cols(), 3);
    return (shape * state.linear.transpose()).rowwise() + state.translation;
}

double DeformableTemplate::add_surface(const State& state, const Points& shape, const MeshSurface& mesh,
                                       double reach, Eigen::MatrixXd& normal,
                                       Eigen::VectorXd& gradient) const {
    const Points own = shape(face_, Eigen::all);
    const Points normals = vertex_normals(shape, triangles_)(face_, Eigen::all);
    const SkinPlaces places = mesh.closest(own);
    const Points there = places.values(mesh.vertices()), facing = places.values(mesh.normals());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(own.rows(), num_unknowns());
    Eigen::VectorXd residuals = Eigen::VectorXd::Zero(own.rows());
    const Eigen::Index num_modes = modes_.rows(), num_bumps = bumps_.cols();
    double on_mesh = 0;
    for (Eigen::Index i = 0; i < own.rows(); ++i) {
        const Eigen::RowVector3d along = normals.row(i);
        if (!(facing.row(i).dot(along) > kAlike * facing.row(i).norm())) {
            continue;
        }
        const double squared = (there.row(i) - own.row(i)).squaredNorm();
        const double weight = reach * reach / (reach * reach + squared);  // Geman and McClure's, its root
        on_mesh += weight;
        const double scale = weight / kPointSigma;
        const Eigen::Index vertex = face_[static_cast<std::size_t>(i)];
        const Eigen::RowVector3d on_template = along * state.linear, from = own.row(i) - state.translation;
        rows.row(i).head(num_modes) =
            (modes_.middleCols(3 * vertex, 3) * on_template.transpose()).transpose();
        for (Eigen::Index k = 0; k < 3; ++k) {
            rows.row(i).segment(num_modes + k * num_bumps, num_bumps) = on_template[k] * bumps_.row(vertex);
        }
        rows.row(i).tail(kPose) << from.cross(along), from.dot(along), along;
        rows.row(i) *= scale;
        residuals[i] = scale * (there.row(i) - own.row(i)).dot(along);
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    gradient += rows.transpose() * residuals;
    return 1 - on_mesh / static_cast<double>(own.rows());
}

Eigen::MatrixXd DeformableTemplate::motion(const State& state, const Points& shape,
                                           const std::vector<int>& rows) const {
    const Eigen::Index num_modes = modes_.rows(), num_bumps = bumps_.cols();
    Eigen::MatrixXd motion(3 * static_cast<Eigen::Index>(rows.size()), num_unknowns());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        auto own = motion.middleRows(3 * static_cast<Eigen::Index>(i), 3);
        own.leftCols(num_modes) = state.linear * modes_.middleCols(3 * rows[i], 3).transpose();
        for (Eigen::Index k = 0; k < 3; ++k) {
            own.middleCols(num_modes + k * num_bumps, num_bumps) = state.linear.col(k) * bumps_.row(rows[i]);
        }
        const Eigen::Vector3d from = (shape.row(rows[i]) - state.translation).transpose();
        own.rightCols(kPose) << 0, from.z(), -from.y(), from.x(), 1, 0, 0,  //
            -from.z(), 0, from.x(), from.y(), 0, 1, 0,                      //
            from.y(), -from.x(), 0, from.z(), 0, 0, 1;
    }
    return motion;
}

LaidVertices DeformableTemplate::lay(const std::vector<int>& rows, PointsIn targets, VectorIn sigma,
                                     PointsIn vertices, PointsIn normals, TrianglesIn triangles) const {
    require(targets.rows() == static_cast<Eigen::Index>(rows.size()) && sigma.size() == targets.rows() &&
                normals.rows() == vertices.rows(),
            "each landmark needs a target and a doubt, and each vertex a normal");
    require(targets.allFinite() && sigma.allFinite() && (sigma.array() > 0).all(),
            "a landmark's target is not finite, or its doubt not above zero");
    for (const int row : rows) {
        require(row >= 0 && row < vertices_.rows(), "a landmark is no vertex of the template");
    }
    const MeshSurface mesh(vertices, normals, triangles);
    const Eigen::VectorXd information =
        kLandmarkWeight * sigma.array().square().inverse().matrix().replicate(1, 3).transpose().reshaped();
    State state{Eigen::VectorXd::Zero(modes_.rows()), Eigen::VectorXd::Zero(3 * bumps_.cols())};
    LaidVertices laid;
    for (int round = 0; round < kRounds; ++round) {
        const double reach = kFirstReach * std::pow(kLastReach / kFirstReach, round / (kRounds - 1.));
        const Points now = shape(state);
        const Eigen::MatrixXd moves = motion(state, now, rows);
        const Points gaps = targets - now(rows, Eigen::all);
        Eigen::MatrixXd normal = moves.transpose() * information.asDiagonal() * moves;
        Eigen::VectorXd gradient =
            moves.transpose() * information.cwiseProduct(gaps.reshaped<Eigen::RowMajor>());
        const Eigen::Index num_shape = num_unknowns() - kPose;
        normal.diagonal().head(num_shape).array() += 1;  // in standard deviations of the prior
        gradient.head(state.modes.size()) -= state.modes;
        gradient.segment(state.modes.size(), state.bumps.size()) -= state.bumps;
        laid.misfit = add_surface(state, now, mesh, reach, normal, gradient);
        const Eigen::LLT<Eigen::MatrixXd> solver(normal);
        require(solver.info() == Eigen::Success, "the landmarks do not tell how the template lies");
        state.step(solver.solve(gradient));
        const Eigen::VectorXd variances =
            (moves.array() * solver.solve(moves.transpose()).transpose().array()).rowwise().sum();
        laid.sigma = variances.reshaped(3, targets.rows()).colwise().sum().cwiseSqrt().transpose();
    }
    laid.places = shape(state)(rows, Eigen::all);
    return laid;
}

}  // namespace mimetic
