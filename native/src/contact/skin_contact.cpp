// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mimetic/contact/skin_contact.hpp>
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/muscles/attach.hpp>
#include <mimetic/shared/error.hpp>
#include <numeric>
#include <utility>

namespace mimetic {
namespace {

constexpr Eigen::Index kBlock = 64;  // responses solved at once
constexpr float kNoticed = .002f;    // of the displacement where a force acts; below, a vertex is not moved
constexpr double kSink = .0006;  // m; at half closure a lid's chord lies so deep inside its arc, on the eye

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows of points (C x B) by the columns that they use, in order; the columns are left in `used`.
SparseRows compact(const SparseRows& stencils, std::vector<int>& used) {
    std::vector<int> number(static_cast<std::size_t>(stencils.cols()), -1);
    for (Eigen::Index row = 0; row < stencils.rows(); ++row) {
        for (SparseRows::InnerIterator entry(stencils, row); entry; ++entry) {
            number[static_cast<std::size_t>(entry.col())] = 0;
        }
    }
    for (std::size_t column = 0; column < number.size(); ++column) {
        if (number[column] == 0) {
            number[column] = static_cast<int>(used.size());
            used.push_back(static_cast<int>(column));
        }
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index row = 0; row < stencils.rows(); ++row) {
        for (SparseRows::InnerIterator entry(stencils, row); entry; ++entry) {
            entries.emplace_back(row, number[static_cast<std::size_t>(entry.col())], entry.value());
        }
    }
    SparseRows result(stencils.rows(), static_cast<Eigen::Index>(used.size()));
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

/// What the base vertices are of the model's unknowns, B x U.
SparseRows basis_of(const YieldingSkin& skin) {
    SparseRows carrier = skin.carrier;
    if (carrier.rows() == 0) {
        const auto count = static_cast<Eigen::Index>(skin.free.size());
        carrier.resize(count, count);
        carrier.setIdentity();
    }
    Flags free(static_cast<Eigen::Index>(skin.free.size()));
    std::copy(skin.free.begin(), skin.free.end(), free.begin());
    SparseRows basis = keep_columns(carrier, free);
    if (basis.cols() != skin.model.num_unknowns()) {
        throw InvalidInput("the skin's model has " + std::to_string(skin.model.num_unknowns()) +
                           " unknowns, " + std::to_string(basis.cols()) + " vertices are free");
    }
    return basis;
}

/// Motion of the model's unknowns under unit upward forces on base vertices.
class Lift {
public:
    /// lifted: rows of the basis of the vertices that forces act on, F x U
    Lift(const SkinModel& model, const SparseRows& lifted) : model_(model), lifted_(lifted) {}

    /// upwards: M x F newtons, M x 3U metres
    MatrixRows solve(const MatrixRows& upwards) const {
        Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(3 * model_.num_unknowns(), upwards.rows());
        loads(Eigen::seqN(1, model_.num_unknowns(), 3), Eigen::all) =
            lifted_.transpose() * upwards.transpose();
        return model_.solve_loads(loads).transpose();
    }

private:
    const SkinModel& model_;
    const SparseRows& lifted_;
};

/// Which base vertices move enough to be noticed. unknowns: M x 3U; basis: B x U.
std::vector<bool> noticed(const FloatRows& unknowns, const SparseRows& basis) {
    std::vector<bool> carries(static_cast<std::size_t>(basis.cols()), false);
    for (Eigen::Index m = 0; m < unknowns.rows(); ++m) {
        const float least = kNoticed * std::max(unknowns.row(m).cwiseAbs().maxCoeff(), 1e-30f);
        for (std::size_t v = 0; v < carries.size(); ++v) {
            const float moved =
                unknowns.row(m).segment<3>(3 * static_cast<Eigen::Index>(v)).cwiseAbs().maxCoeff();
            carries[v] = carries[v] || moved > least;
        }
    }
    std::vector<bool> result(static_cast<std::size_t>(basis.rows()), false);
    for (Eigen::Index row = 0; row < basis.rows(); ++row) {
        for (SparseRows::InnerIterator entry(basis, row); entry; ++entry) {
            if (carries[static_cast<std::size_t>(entry.col())]) {
                result[static_cast<std::size_t>(row)] = true;
            }
        }
    }
    return result;
}

}  // namespace

struct SkinContact::Parts {
    std::vector<EyeRest> eyes;
    SparseRows stencils;  // C x U
    std::vector<int> vertices, moved;
    std::vector<Eigen::Index> on_eyes;  // of what lies on eyes, the row of `moved`
    bool by_vertex = false;             // loads are on the base vertices, not on the points
    FloatRows response;                 // loads x 3W; while it is solved, x 3U of the model's unknowns
    int num_slits = 0;
    std::unique_ptr<const ContactSolver> solver;

    void solve(const TouchPoints& touch, const SkinModel& model, const SparseRows& lifted);
    void keep_moved(const YieldingSkin& skin, const SparseRows& basis, const std::vector<int>& lids);
};

Points EyeRest::push(PointsIn displacement) const {
    Points result(displacement.rows(), 3);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        const Eigen::RowVector3d arm = rest.row(i) + displacement.row(i) - centre.transpose();
        const double least = (rest.row(i) - centre.transpose()).norm() - sink;
        const double length = arm.norm();
        result.row(i) = share[i] * std::max(least - length, 0.) / std::max(length, 1e-9) * arm;
    }
    return result;
}

EyeRest rest_on_eye(const MuscleSurface& surface, PointsIn margin, PointsIn rest,
                    const Eigen::Vector3d& centre, double reach, double size) {
    const Eigen::VectorXd way = surface.distances(margin, reach);
    EyeRest eye;
    eye.centre = centre;
    eye.sink = kSink * size;
    std::vector<double> shares;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        if (way[v] < reach) {
            eye.vertices.push_back(static_cast<int>(v));
            shares.push_back(smooth_step(2 - 2 * way[v] / reach));
        }
    }
    eye.rest = rest(eye.vertices, Eigen::all);
    eye.share = Eigen::Map<const Eigen::VectorXd>(shares.data(), static_cast<Eigen::Index>(shares.size()));
    return eye;
}

void SkinContact::Parts::solve(const TouchPoints& touch, const SkinModel& model, const SparseRows& lifted) {
    // Forces on points come down to forces on base vertices: solved are the fewer of the two
    by_vertex = stencils.cols() < stencils.rows();
    const SparseRows narrow = stencils.cast<float>().cast<double>();
    const SparseRows at_points = narrow * lifted;
    const MatrixRows loads =
        by_vertex ? MatrixRows(MatrixRows::Identity(narrow.cols(), narrow.cols())) : MatrixRows(narrow);
    const Lift lift(model, lifted);
    response.resize(loads.rows(), 3 * lifted.cols());
    FloatRows points(loads.rows(), 3 * narrow.rows());
    for (Eigen::Index start = 0; start < loads.rows(); start += kBlock) {
        const Eigen::Index count = std::min(kBlock, loads.rows() - start);
        const MatrixRows solved = lift.solve(loads.middleRows(start, count));
        response.middleRows(start, count) = solved.cast<float>();
        for (Eigen::Index m = 0; m < count; ++m) {
            const Points at = at_points * Eigen::Map<const Points>(solved.row(m).data(), lifted.cols(), 3);
            points.row(start + m) = Eigen::Map<const Eigen::RowVectorXd>(at.data(), at.size()).cast<float>();
        }
    }
    if (by_vertex) {
        const Eigen::SparseMatrix<float, Eigen::RowMajor> weights = narrow.cast<float>();
        points = FloatRows(weights * points);
    }
    solver = std::make_unique<const ContactSolver>(touch.rest, touch.slits, points);
}

void SkinContact::Parts::keep_moved(const YieldingSkin& skin, const SparseRows& basis,
                                    const std::vector<int>& lids) {
    const std::vector<bool> moves = noticed(response, basis);
    std::vector<int> row(skin.moves_with.size(), -1);
    std::vector<bool> is_on_eye(skin.moves_with.size(), false);
    for (const int vertex : lids) {
        is_on_eye.at(static_cast<std::size_t>(skin.read[static_cast<std::size_t>(vertex)])) = true;
    }
    for (std::size_t v = 0; v < skin.moves_with.size(); ++v) {
        const int with = skin.moves_with[v];
        if (is_on_eye[v] || (with >= 0 && moves.at(static_cast<std::size_t>(with)))) {
            row[v] = static_cast<int>(moved.size());
            moved.push_back(static_cast<int>(v));
        }
    }
    for (const int vertex : lids) {
        on_eyes.push_back(row[static_cast<std::size_t>(skin.read[static_cast<std::size_t>(vertex)])]);
    }
    std::vector<int> base;
    std::vector<Eigen::Index> columns;
    for (std::size_t w = 0; w < moved.size(); ++w) {
        if (const int with = skin.moves_with[static_cast<std::size_t>(moved[w])]; with >= 0) {
            base.push_back(with);
            columns.push_back(3 * static_cast<Eigen::Index>(w));
        }
    }
    const Eigen::SparseMatrix<float, Eigen::RowMajor> rows = keep_rows(basis, base).cast<float>();
    FloatRows kept = FloatRows::Zero(response.rows(), 3 * static_cast<Eigen::Index>(moved.size()));
    for (Eigen::Index m = 0; m < response.rows(); ++m) {
        const Corrections at = rows * Eigen::Map<const Corrections>(response.row(m).data(), basis.cols(), 3);
        for (std::size_t i = 0; i < columns.size(); ++i) {
            kept.row(m).segment<3>(columns[i]) = at.row(static_cast<Eigen::Index>(i));
        }
    }
    response = std::move(kept);
}

SkinContact::SkinContact(const TouchPoints& touch, const std::vector<EyeRest>& eyes,
                         const YieldingSkin& skin) {
    const auto num_base = static_cast<Eigen::Index>(skin.read.size());
    if (touch.stencils.cols() != num_base || (skin.carrier.rows() != 0 && skin.carrier.rows() != num_base)) {
        throw InvalidInput("contact is given a skin of different numbers of vertices");
    }
    auto parts = std::make_shared<Parts>();
    parts->eyes = eyes;
    parts->num_slits = static_cast<int>(touch.slits.size());
    std::vector<int> used, lids;
    parts->stencils = compact(touch.stencils, used);
    for (const EyeRest& eye : eyes) {
        lids.insert(lids.end(), eye.vertices.begin(), eye.vertices.end());
    }
    for (const std::vector<int>* base : {&used, &lids}) {
        for (const int vertex : *base) {
            parts->vertices.push_back(skin.read.at(static_cast<std::size_t>(vertex)));
        }
    }
    const SparseRows basis = basis_of(skin);
    parts->solve(touch, skin.model, keep_rows(basis, used));
    parts->keep_moved(skin, basis, lids);
    parts_ = std::move(parts);
}

const std::vector<int>& SkinContact::vertices() const { return parts_->vertices; }
const std::vector<int>& SkinContact::moved() const { return parts_->moved; }
int SkinContact::num_slits() const { return parts_->num_slits; }

Points SkinContact::push(PointsIn displacement) const {
    Points result(displacement.rows(), 3);
    Eigen::Index start = 0;
    for (const EyeRest& eye : parts_->eyes) {
        const Eigen::Index count = eye.rest.rows();
        result.middleRows(start, count) = eye.push(displacement.middleRows(start, count));
        start += count;
    }
    return result;
}

Points SkinContact::yield(const Eigen::VectorXd& forces) const {
    const Eigen::VectorXd whole =
        parts_->by_vertex ? Eigen::VectorXd(parts_->stencils.transpose() * forces) : forces;
    const Eigen::VectorXf loads = whole.cast<float>();
    Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(parts_->response.cols());
    for (Eigen::Index k = 0; k < loads.size(); ++k) {
        if (loads[k] != 0) {
            sum += loads[k] * parts_->response.row(k);
        }
    }
    return Eigen::Map<const Corrections>(sum.data(), sum.size() / 3, 3).cast<double>();
}

std::optional<SkinContact::Corrections> SkinContact::correction(PointsIn displacement) const {
    if (displacement.rows() != static_cast<Eigen::Index>(parts_->vertices.size())) {
        throw InvalidInput("contact looks at " + std::to_string(parts_->vertices.size()) +
                           " vertices, got displacements of " + std::to_string(displacement.rows()));
    }
    const Points own = displacement * turn_.inverse().transpose();
    const Eigen::Index num_columns = parts_->stencils.cols();
    const Points lids = own.bottomRows(own.rows() - num_columns);
    const Points at_points = parts_->stencils * own.topRows(num_columns);
    const Eigen::VectorXd forces = parts_->solver->solve(at_points);
    const bool is_parted = (forces.array() != 0).any();
    if (!is_parted && !(push(lids).array() != 0).any()) {
        return std::nullopt;
    }
    Points correction = is_parted ? yield(forces) : Points::Zero(parts_->response.cols() / 3, 3);
    const Points relieved = lids + correction(parts_->on_eyes, Eigen::all);
    correction(parts_->on_eyes, Eigen::all) += push(relieved);
    return Corrections((correction * turn_.transpose()).cast<float>());
}

Points SkinContact::at_vertices(PointsIn displacement) const {
    for (const int vertex : parts_->vertices) {
        if (vertex >= displacement.rows()) {
            throw InvalidInput("contact is of a head of more than " + std::to_string(displacement.rows()) +
                               " vertices");
        }
    }
    return displacement(parts_->vertices, Eigen::all);
}

Points SkinContact::relieve(PointsIn displacement) const {
    Points relieved = displacement;
    if (const auto corrected = correction(at_vertices(displacement))) {
        for (std::size_t w = 0; w < parts_->moved.size(); ++w) {
            relieved.row(parts_->moved[w]) += corrected->row(static_cast<Eigen::Index>(w)).cast<double>();
        }
    }
    return relieved;
}

Eigen::VectorXd SkinContact::gaps(PointsIn displacement) const {
    const Points own =
        at_vertices(displacement).topRows(parts_->stencils.cols()) * turn_.inverse().transpose();
    const Points at_points = parts_->stencils * own;
    return parts_->solver->gaps(at_points);
}

SkinContact SkinContact::turned(const Eigen::Matrix3d& linear) const {
    SkinContact other = *this;
    other.turn_ = linear * turn_;
    return other;
}

}  // namespace mimetic
