// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mimetic/muscles/skin_mesh.hpp>
#include <optional>

namespace mimetic {

/// What bone does and skin muscles do not.
enum class JawMotion { jaw_open, jaw_side, jaw_thrust };

/// The name in a command or a file; throws InvalidInput on another.
JawMotion jaw_motion(const std::string& name);

/// Points (K x 3) turned about an axis (unit) through a centre by angles (K), radians.
Points rotate(PointsIn points, const Eigen::RowVector3d& centre, const Eigen::RowVector3d& axis,
              VectorIn angles);

/// 0 below 0, 1 above 1, with no kink.
double smooth_step(double value);

/// The mandible: turns about the condyles; what is fixed to it follows. Displacements are those at value 1,
/// exact rotations, not linearised: an open jaw keeps its size. Metres, head frame.
class Jaw {
public:
    explicit Jaw(std::shared_ptr<const SkinMesh> mesh);

    const Eigen::RowVector3d& hinge() const { return hinge_; }
    std::vector<int> rigid_vertices() const;  ///< control vertices fixed to the bone: lower teeth, tongue

    Points motion(JawMotion motion, PointsIn points) const;  ///< displacement of points of the bone, K x 3
    Points under_skin(JawMotion which) const;  ///< displacement of the bone under the refined skin, N x 3

    /// 0 (skull) to 1 (jaw) for the bone under each refined skin vertex, N.
    const Eigen::VectorXd& influence() const { return influence_; }

private:
    Eigen::VectorXd find_influence() const;

    std::shared_ptr<const SkinMesh> mesh_;
    Eigen::RowVector3d hinge_;
    Eigen::VectorXd influence_;
};

/// One eye: centre, axis through which its lids turn, and the vertices that follow them.
struct EyeFrame {
    /// Position along the axis (m), elevation (radians) and distance from the axis (m) of K points.
    struct Polar {
        Eigen::VectorXd along, elevation, radius;
    };

    /// side: 'L' or 'R'; own_centre: of an eyeball that is not the template's. Throws InvalidInput.
    EyeFrame(std::shared_ptr<const SkinMesh> mesh, char side,
             const std::optional<Eigen::Vector3d>& own_centre = std::nullopt);

    Polar polar(PointsIn points) const;

    std::shared_ptr<const SkinMesh> mesh;
    char side;
    Eigen::RowVector3d centre;
    /// From the inner to the outer corner (left eye; the right eye's points inwards): a positive angle turns
    /// the front of the eye down.
    Eigen::RowVector3d axis;
    std::vector<int> margin;  ///< control vertices on the edge of this eye's lids
    std::vector<int> lashes;  ///< control vertices
    std::vector<int> roots;   ///< the vertex of the lids' margin that each of the lashes follows
};

/// Upper lid closing onto the lower one, lower lid rising: both turn about the eye.
class EyeLids {
public:
    static constexpr double kReach = 0.013;  ///< m on the template, from the margin to the upper lid's fold

    explicit EyeLids(EyeFrame frame);

    const EyeFrame& frame() const { return frame_; }
    const std::vector<int>& upper() const { return upper_; }  ///< control vertices of the margin
    const std::vector<int>& lower() const { return lower_; }  ///< likewise; both have the corners

    /// Angle between the margins, radians, by the position along the axis (K); 0 at the corners.
    Eigen::VectorXd opening(VectorIn along) const;

    /// How far the skin turns about the eye with the upper and with the lower lid at value 1, S radians.
    Eigen::VectorXd upper_angle() const;
    Eigen::VectorXd lower_angle() const;

    /// V x 3: skin turned about the eye by angles (S, down), lashes with their roots.
    Points turn(VectorIn angle) const;

private:
    /// Skin turns fully within `full` of the margin, fading to 0 at `end`, metres on the template.
    struct Fade {
        double full, end;
    };

    Eigen::VectorXd raise(VectorIn along) const;
    Eigen::VectorXd share(const std::vector<int>& margin, const std::vector<int>& other,
                          const Fade& fade) const;

    EyeFrame frame_;
    std::vector<int> upper_, lower_;
};

/// The skin's control vertex that each of the head's V goes with, -1 for none: lashes go with their roots.
Eigen::VectorXi followed_vertices(const std::shared_ptr<const SkinMesh>& mesh);

/// Modes of a skin (M x 3S, xyz interleaved) over a whole head (M x 3V), each vertex of which goes with one
/// of the skin's, or with none (-1). Throws InvalidInput.
MatrixRows spread(MatrixIn skin_modes, const Eigen::VectorXi& moves_with);

}  // namespace mimetic
