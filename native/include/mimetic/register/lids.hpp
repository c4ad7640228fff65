// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/muscles/articulators.hpp>
#include <mimetic/muscles/muscles.hpp>
#include <mimetic/surface/skin_places.hpp>
#include <vector>

namespace mimetic {

/// A head's own eyeball, of one shell or several, seen from its middle through the front.
class EyeSurface {
public:
    EyeSurface() = default;  ///< of a head without eyeballs: nothing lies inside
    /// vertices: V x 3, metres; triangles: T x 3, outward. Throws InvalidInput.
    EyeSurface(const Eigen::Vector3d& centre, PointsIn vertices, TrianglesIn triangles);

    bool is_there() const { return !shells_.empty(); }

    /// How deep points (K x 3) lie under its outermost shell, K, metres, negative outside; minus infinity
    /// where it has none before them.
    Eigen::VectorXd depths(PointsIn points) const;

    /// The points, those that lie deeper than `clearance` above it (metres) lifted to there.
    Points lifted(PointsIn points, double clearance) const;

private:
    Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
    Points vertices_;  // from the centre
    std::vector<Triangles> shells_;
};

/// Places on a skin in pairs, across a slit.
struct SlitPlaces {
    SkinPlaces upper, lower;
};

/// The rims of an eye as a skin has them: where it is cut by planes across the lids, the lowest place of the
/// upper lid and the highest of the lower one, seen from the eye's middle. A registered rim (top, bottom: K x
/// 3 in pairs, metres) says where to look; pairs that the skin bridges are left out. vertices: N x 3.
SlitPlaces lid_rims(const EyeFrame& frame, PointsIn vertices, TrianglesIn triangles, PointsIn top,
                    PointsIn bottom);

/// Whether skin covers a slit: the way along it from rim to rim is hardly longer than the gap. top, bottom: K
/// x 3, in pairs.
bool are_joined(const MuscleSurface& surface, PointsIn top, PointsIn bottom);

/// Least lengths that a point of skin within `reach` (metres) of rims lies inside an eye: the largest depth
/// of its vertices and of the middles of its edges, displaced, of those that are outside at rest; 0 if none.
double largest_depth(const MuscleSurface& surface, PointsIn displacement, const SlitPlaces& rims,
                     const EyeSurface& eye, double reach);

}  // namespace mimetic
