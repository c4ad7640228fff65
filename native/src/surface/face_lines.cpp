// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/raster/depth.hpp>
#include <mimetic/shared/error.hpp>
#include <mimetic/surface/face_lines.hpp>
#include <mimetic/surface/surface.hpp>
#include <optional>
#include <string>

namespace mimetic {
namespace {

constexpr double kDepthSide = 256;    // pixels: the longer side of the face's depth map
constexpr double kDepthMargin = 2;    // pixels of it around the face
constexpr double kBehindSkin = 4e-3;  // metres that a line may lie behind the surface and still be seen
constexpr double kUnderLid = 1e-3;    // metres behind the skin at which an iris is covered
constexpr double kNearest = 1e-3;     // metres from the camera

/// A part of the camera's picture at another resolution.
Camera cut_out(const Camera& camera, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    const double scale = kDepthSide / std::max((high - low).maxCoeff(), 1.);
    const auto side = [scale](double length) { return std::max(1, int(std::ceil(length * scale))); };
    return {camera.fx * scale,
            camera.fy * scale,
            (camera.cx - low.x()) * scale,
            (camera.cy - low.y()) * scale,
            side(high.x() - low.x()),
            side(high.y() - low.y())};
}

/// The part of the picture that a face is in; none if it is beside the picture.
std::optional<Camera> camera_of_face(const Camera& camera, PointsIn points) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        if (points(i, 2) > kNearest) {
            const Eigen::Vector2d pixel = camera.project(points.row(i));
            low = low.cwiseMin(pixel);
            high = high.cwiseMax(pixel);
        }
    }
    const double margin = kDepthMargin * std::max((high - low).maxCoeff(), 1.) / kDepthSide;
    low = (low.array() - margin).matrix().cwiseMax(Eigen::Vector2d(-.5, -.5));
    high = (high.array() + margin).matrix().cwiseMin(Eigen::Vector2d(camera.width - .5, camera.height - .5));
    if (!((high - low).array() > 0).all()) {
        return std::nullopt;
    }
    return cut_out(camera, low, high);
}

/// Collects lines between points that are seen.
class Lines {
public:
    Lines(const Camera& camera, const DepthMap& depth, const Camera& depth_camera)
        : camera_(camera), depth_(depth), depth_camera_(depth_camera) {}

    bool shows(const Eigen::Vector3d& point, double tolerance) const {
        return depth_.shows(depth_camera_, point, tolerance);
    }
    void add(std::vector<float>& ends, const Eigen::Vector3d& point) const {
        const Eigen::Vector2d pixel = camera_.project(point);
        ends.push_back(static_cast<float>((pixel.x() + .5) / camera_.width));
        ends.push_back(static_cast<float>(1 - (pixel.y() + .5) / camera_.height));
    }
    /// From one to the next of K points, as far as both are seen.
    PicturePlaces along(const std::vector<Points>& lines, double tolerance, bool is_closed) const {
        std::vector<float> ends;
        for (const Points& line : lines) {
            const Eigen::Index count = line.rows();
            for (Eigen::Index i = 0; i < (is_closed ? count : count - 1); ++i) {
                const Eigen::Vector3d from = line.row(i), to = line.row((i + 1) % count);
                if (shows(from, tolerance) && shows(to, tolerance)) {
                    add(ends, from);
                    add(ends, to);
                }
            }
        }
        return places(ends);
    }
    static PicturePlaces places(const std::vector<float>& ends) {
        return Eigen::Map<const PicturePlaces>(ends.data(), static_cast<Eigen::Index>(ends.size() / 2), 2);
    }

private:
    const Camera& camera_;
    const DepthMap& depth_;
    const Camera& depth_camera_;
};

/// Numbers the vertices that are used, in order; -1 for the others.
std::vector<int> numbering(const std::vector<bool>& is_used) {
    std::vector<int> numbers(is_used.size(), -1);
    int next = 0;
    for (std::size_t v = 0; v < is_used.size(); ++v) {
        if (is_used[v]) {
            numbers[v] = next++;
        }
    }
    return numbers;
}

/// What is drawn: faces, and vertices by their new numbers.
struct Drawn {
    Quads faces;
    std::vector<int> kept;  // control vertices, in the new order
    FaceLines::Parts parts;
};

Drawn drawn_part(QuadsIn faces, Eigen::Index num_vertices, const FaceLines::Parts& parts) {
    if (parts.is_shown.size() != static_cast<std::size_t>(faces.rows())) {
        throw InvalidInput("the lines of a face need to know of each of its " + std::to_string(faces.rows()) +
                           " faces whether it is shown");
    }
    Drawn drawn{{}, {}, parts};
    std::vector<Eigen::Index> rows;
    std::vector<bool> is_used(static_cast<std::size_t>(num_vertices));
    const auto use = [&](int vertex) {
        if (vertex < 0 || vertex >= num_vertices) {
            throw InvalidInput("a line or mark names a vertex outside 0 to " +
                               std::to_string(num_vertices - 1));
        }
        is_used[static_cast<std::size_t>(vertex)] = true;
    };
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        if (parts.is_shown[static_cast<std::size_t>(f)]) {
            rows.push_back(f);
            std::for_each(faces.row(f).begin(), faces.row(f).end(), use);
        }
    }
    for (const std::vector<int>& line : parts.features) {
        std::for_each(line.begin(), line.end(), use);
    }
    std::for_each(parts.marks.begin(), parts.marks.end(), use);
    const std::vector<int> numbers = numbering(is_used);
    const auto renumber = [&](int& vertex) { vertex = numbers[static_cast<std::size_t>(vertex)]; };
    drawn.faces = faces(rows, Eigen::all);
    std::for_each(drawn.faces.data(), drawn.faces.data() + drawn.faces.size(), renumber);
    for (std::vector<int>& line : drawn.parts.features) {
        std::for_each(line.begin(), line.end(), renumber);
    }
    std::for_each(drawn.parts.marks.begin(), drawn.parts.marks.end(), renumber);
    for (int v = 0; v < num_vertices; ++v) {
        if (is_used[static_cast<std::size_t>(v)]) {
            drawn.kept.push_back(v);
        }
    }
    return drawn;
}

}  // namespace

FaceLines::FaceLines(const Camera& camera, PointsIn neutral, MatrixIn modes, QuadsIn faces,
                     const Parts& parts)
    : camera_(camera), mesh_(Quads(0, 4), 0) {
    camera.check();
    const Eigen::Index num_vertices = neutral.rows();
    if (modes.cols() != 3 * num_vertices) {
        throw InvalidInput("modes must have one displacement for each of the " +
                           std::to_string(num_vertices) + " vertices");
    }
    if (!neutral.allFinite() || !modes.allFinite()) {
        throw InvalidInput("a vertex or a mode of the face is not finite");
    }
    const SubdividedMesh limit(faces, static_cast<int>(num_vertices), 0);
    Drawn drawn = drawn_part(faces, num_vertices, parts);
    const auto kept = static_cast<Eigen::Index>(drawn.kept.size());
    neutral_ = limit.positions(neutral)(drawn.kept, Eigen::all);
    modes_.resize(modes.rows(), 3 * kept);
    for (Eigen::Index m = 0; m < modes.rows(); ++m) {
        const Points moved = limit.positions(Eigen::Map<const Points>(modes.row(m).data(), num_vertices, 3));
        const Points part = moved(drawn.kept, Eigen::all);
        modes_.row(m) = Eigen::Map<const Eigen::RowVectorXd>(part.data(), part.size()).cast<float>();
    }
    mesh_ = QuadEdges(drawn.faces, kept);
    features_ = std::move(drawn.parts.features);
    marks_ = std::move(drawn.parts.marks);
}

Points FaceLines::in_camera(VectorIn values, const Eigen::Isometry3d& camera_from_head) const {
    if (values.size() != modes_.rows() || !values.allFinite()) {
        throw InvalidInput("the face is drawn by " + std::to_string(modes_.rows()) + " finite values, got " +
                           std::to_string(values.size()));
    }
    const Eigen::RowVectorXf moved = values.cast<float>().transpose() * modes_;
    const Points displacement =
        Eigen::Map<const Rows<float, 3>>(moved.data(), neutral_.rows(), 3).cast<double>();
    Points points = (neutral_ + displacement) * camera_from_head.linear().transpose();
    points.rowwise() += camera_from_head.translation().transpose();
    return points;
}

DrawnLines FaceLines::draw(VectorIn values, const Eigen::Isometry3d& camera_from_head,
                           const std::vector<Points>& rings) const {
    const Points points = in_camera(values, camera_from_head);
    const auto num_marks = static_cast<Eigen::Index>(marks_.size());
    DrawnLines drawn{PicturePlaces(0, 2), PicturePlaces(0, 2), PicturePlaces(0, 2),
                     PicturePlaces::Constant(num_marks, 2, std::numeric_limits<float>::quiet_NaN()),
                     std::vector<bool>(marks_.size())};
    const std::optional<Camera> depth_camera = camera_of_face(camera_, points);
    if (!depth_camera) {
        return drawn;
    }
    const DepthMap depth = render_depth(*depth_camera, points, mesh_.faces());
    const Lines lines(camera_, depth, *depth_camera);
    std::vector<bool> is_seen(static_cast<std::size_t>(points.rows()));
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        is_seen[static_cast<std::size_t>(i)] = lines.shows(points.row(i), kBehindSkin);
    }
    const auto seen = [&is_seen](int vertex) { return is_seen[static_cast<std::size_t>(vertex)]; };
    const std::vector<bool> turned = mesh_.turned_to_camera(points);
    std::vector<float> ends;
    for (const QuadEdges::Edge& edge : mesh_.edges()) {
        if (seen(edge.first) && seen(edge.second) && QuadEdges::is_turned(edge, turned)) {
            lines.add(ends, points.row(edge.first));
            lines.add(ends, points.row(edge.second));
        }
    }
    drawn.mesh = Lines::places(ends);
    std::vector<Points> feature_points, rings_in_camera;
    for (const std::vector<int>& line : features_) {
        feature_points.emplace_back(points(line, Eigen::all));
    }
    drawn.features = lines.along(feature_points, kBehindSkin, false);
    for (const Points& ring : rings) {
        Points moved = ring * camera_from_head.linear().transpose();
        moved.rowwise() += camera_from_head.translation().transpose();
        rings_in_camera.push_back(std::move(moved));
    }
    drawn.rings = lines.along(rings_in_camera, kUnderLid, true);
    for (Eigen::Index k = 0; k < num_marks; ++k) {
        const int vertex = marks_[static_cast<std::size_t>(k)];
        if (points(vertex, 2) > kNearest) {
            std::vector<float> place;
            lines.add(place, points.row(vertex));
            drawn.marks.row(k) << place[0], place[1];
            drawn.marks_shown[static_cast<std::size_t>(k)] = seen(vertex);
        }
    }
    return drawn;
}

}  // namespace mimetic
