// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/batch_space.hpp"

#include <cmath>

namespace mimetic::locate {

void normalize_rows(Windows& windows) {
    for (Eigen::Index i = 0; i < windows.rows(); ++i) {
        auto row = windows.row(i);
        row.array() -= row.mean();
        const float deviation = std::sqrt(row.squaredNorm() / static_cast<float>(row.size()));
        if (deviation > 1e-6f)
            row /= deviation;
        else
            row.setZero();
    }
}

BatchSpace::BatchSpace(const Eigenspace& space)
    : mean_(space.mean.transpose().cast<float>()),
      basis_(space.basis.transpose().cast<float>()),
      precision_(space.eigenvalues.cwiseInverse().transpose().cast<float>()),
      rho_(static_cast<float>(space.rho)) {
    const auto rest = static_cast<double>(space.mean.size() - space.eigenvalues.size());
    normalizer_ =
        static_cast<float>(-0.5 * (space.eigenvalues.array().log().sum() + rest * std::log(space.rho)));
}

BatchSpace::Distances BatchSpace::of(const Windows& normalized) const {
    const Windows off = normalized.rowwise() - mean_;
    const Eigen::MatrixXf modes = off * basis_;
    Distances away;
    away.within = (modes.array().square().rowwise() * precision_.array()).rowwise().sum();
    away.from =
        (off.rowwise().squaredNorm().array() - modes.rowwise().squaredNorm().array()).max(0.0f) / rho_;
    away.log_likelihood = normalizer_ - 0.5f * (away.within + away.from);
    return away;
}

}  // namespace mimetic::locate
