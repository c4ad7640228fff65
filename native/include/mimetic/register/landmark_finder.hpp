// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/register/deformable_template.hpp>
#include <mimetic/register/face_views.hpp>
#include <string>

namespace mimetic {

/// Landmarks that were placed on a mesh, L of them.
struct PlacedLandmarks {
    Points places;          ///< L x 3, on the mesh, in its frame
    Eigen::VectorXd sigma;  ///< L, standard deviation of each, interpupillary distances
    Similarity mesh_from_template;
};

/// Places a template's landmarks on heads of any other make: both are drawn from the front and from both
/// sides, a network that knows faces finds 468 points in each picture, and each landmark is carried along
/// with the points round it. What the network sees wrongly in plain shading it sees wrongly on both;
/// beside a mask, or a head without eyeballs, the template is drawn without these too. Then
/// corners of the eyes follow the openings' ends and the tip of the nose its highest point, where the mesh
/// has such, and the template, laid on the mesh as the person that it shows, says where all of them are.
class LandmarkFinder {
public:
    /// The template: V x 3, metres, head frame; landmarks: names, and vertices; people: who it can be, of
    /// the same vertices. networks: outlive this. Throws InvalidInput: a landmark without a name, or that is
    /// no vertex; a template without a face.
    LandmarkFinder(PointsIn vertices, TrianglesIn triangles, std::vector<std::string> names,
                   std::vector<int> landmarks, DeformableTemplate people, const FeatureNetworks& networks);

    /// vertices: V x 3, any unit and axes, outward triangles. Nothing where no face is seen, or progress
    /// stopped the search. Throws InvalidInput as `shown_head`.
    std::optional<PlacedLandmarks> place(PointsIn vertices, TrianglesIn triangles,
                                         const Progress& progress = {}) const;

private:
    /// Moves corners of eyes and the tip of the nose to where the mesh itself has them. face: 468 x 3.
    void follow_details(const ShownHead& head, const Points& face, PlacedLandmarks& placed) const;

    /// Moves all to where the template has them, laid on the mesh. face: 468 x 3.
    void lay_template(const ShownHead& head, const Points& face, PlacedLandmarks& placed) const;

    std::vector<std::string> names_;
    std::vector<int> rows_;
    Points landmarks_;  ///< L x 3
    DeformableTemplate people_;
    const FeatureNetworks& networks_;
    std::vector<ViewDirection> directions_;
    ShownHead template_;
    std::vector<FaceView> views_;
    std::vector<FeatureCrop> crops_;
};

}  // namespace mimetic
