// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <vector>

namespace mimetic {

/// A third of a quad's triangles' areas for each of V vertices, over quads whose corners are all skin. Square
/// metres.
Eigen::VectorXd skin_areas(PointsIn vertices, QuadsIn faces, const std::vector<bool>& is_skin);

/// S.d. of each vertex's displacement (V, metres) from independent s.d. of values (M) of modes (M x 3V).
Eigen::VectorXd displacement_std(MatrixIn modes, VectorIn stds);

/// Metres, twice the s.d. by which the capture's flow blurs: 7.1 of the 200 rows of a face of 206 mm. Nearer
/// to a moving region than this a capture cannot tell skin that keeps still.
constexpr double kResolved = .015;

/// A measured displacement compared with that of an action unit.
struct SpatialComparison {
    double intensity;                  ///< of the unit, by least squares within its region
    double inside_explained;           ///< R2 of the unit at that intensity within its region
    double outside_share;              ///< of the measured displacement's energy, outside the region
    double outside_significant_share;  ///< the same of what is beyond two standard deviations alone
    double outside_far_share;          ///< of all energy again, farther than kResolved from the region
    double gini;  ///< of squared displacement over areas: 0 spread evenly, 1 in one place
};

/// vertices, of the neutral, seen, unit: V x 3, metres; areas, stds: V; reach: V, above 0 within the unit's
/// region. A unit that does not move, or a face that does not, gives shares that are not numbers. Throws
/// InvalidInput on other lengths.
SpatialComparison compare_displacements(PointsIn vertices, PointsIn seen, PointsIn unit, VectorIn areas,
                                        VectorIn stds, VectorIn reach);

/// How displacement changes over time.
struct TemporalComparison {
    double
        rank_one_share;  ///< of the energy, by one pattern times one curve, as a unit with an intensity has
    double ramp_explained;        ///< R2 of the best straight line through that curve's application
    double ramp_whole_explained;  ///< R2 of straight up, hold, straight down through all of it
    Eigen::VectorXd course;       ///< N, that curve, at most 1
    Eigen::VectorXd ramp;         ///< N, the ramp
};

/// displacements: N x 3V, of consecutive frames, weighted by areas (V); begin, apex: rows of the application.
/// Throws InvalidInput.
TemporalComparison compare_courses(MatrixIn displacements, VectorIn areas, int begin, int apex);

/// The faces of a mesh that are visible along -z, back to front, with their shading.
struct FacesInView {
    std::vector<int> faces;
    Eigen::VectorXd shades;  ///< 0 to 1, of those faces
};
FacesInView faces_in_view(PointsIn vertices, QuadsIn faces);

}  // namespace mimetic
