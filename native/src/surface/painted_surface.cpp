// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mimetic/raster/raster.hpp>
#include <mimetic/shared/checks.hpp>
#include <mimetic/surface/painted_surface.hpp>
#include <opencv2/core/utility.hpp>

namespace mimetic {
namespace {

constexpr float kSlack = 1e-4f;    // of a corner's weight
constexpr float kNearest = 1e-3f;  // metres before the camera
constexpr int kOpaque = 255;       // opacity of a texel that covers what is behind it
const Eigen::Vector3f kLamp =
    Eigen::Vector3f(-.25f, -.45f, -1).normalized();  // camera frame: above, at the left

void check(QuadsIn faces, const Paints& paints) {
    require(paints.picture_of_face.size() == faces.rows() && paints.corners.rows() == 4 * faces.rows(),
            "a painted surface needs a picture and four corners for each face");
    require(paints.brightness.size() > 0 && paints.brightness.allFinite() && paints.corners.allFinite(),
            "a painted surface needs a brightness for each vertex, and places in its pictures");
    const auto count = static_cast<int>(paints.pictures.size());
    require(faces.rows() > 0 && paints.picture_of_face.minCoeff() >= 0 &&
                paints.picture_of_face.maxCoeff() < count,
            "a face of a painted surface names a picture that there is not");
    for (const Paint& paint : paints.pictures) {
        const auto size = static_cast<std::size_t>(paint.rows) * static_cast<std::size_t>(paint.cols) * 4;
        require(paint.rows > 0 && paint.cols > 0 && paint.pixels.size() == size,
                "a picture of a painted surface has other pixels than its size says");
    }
}

bool is_see_through(const Paint& paint) {
    for (std::size_t i = 3; i < paint.pixels.size(); i += 4) {
        if (paint.pixels[i] < kOpaque) {
            return true;
        }
    }
    return false;
}

/// Corners of the refined faces (4 each), as parts of their pictures.
Points2 refined_corners(const SubdividedMesh& mesh, int levels, Points2In corners) {
    const int side = 1 << levels;
    Points2 refined(4 * mesh.faces().rows(), 2);
    for (Eigen::Index f = 0; f < mesh.faces().rows(); ++f) {
        const int child = static_cast<int>(f % (side * side));
        const Eigen::Matrix<double, 4, 2> of_parent = corners.middleRows<4>(4 * mesh.parent_face()[f]);
        for (int k = 0; k < 4; ++k) {
            const double s = (child % side + (k == 1 || k == 2 ? 1 : 0)) / static_cast<double>(side);
            const double t = (child / side + (k >= 2 ? 1 : 0)) / static_cast<double>(side);
            const Eigen::RowVector4d shares((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t);
            refined.row(4 * f + k) = shares * of_parent;
        }
    }
    return refined;
}

}  // namespace

/// What samples show in a part of the picture: of the faces of one kind, the nearest.
struct PaintedSurface::Layer {
    int left, top;                         // of the part
    Raster raster;                         // face: 2 * quad + half
    std::vector<Eigen::Vector2f> weights;  // of the half's second and third corner, in space

    /// The part of a picture that holds these points; nothing where none is in it.
    Layer(const Camera& camera, const Rows<float, 2>& pixels, const std::vector<int>& vertices) {
        Eigen::Array2f low(static_cast<float>(camera.width), static_cast<float>(camera.height));
        Eigen::Array2f high(-1, -1), end = low;
        for (const int vertex : vertices) {
            low = low.min(pixels.row(vertex).transpose().array());
            high = high.max(pixels.row(vertex).transpose().array());
        }
        low = low.floor().max(0).min(end);
        high = (high.floor() + 1).max(low).min(end);
        left = static_cast<int>(low.x());
        top = static_cast<int>(low.y());
        raster.clear(static_cast<int>(high.y()) - top, static_cast<int>(high.x()) - left);
        weights.resize(raster.face.size());
    }

    /// Where a pixel of the picture is in the raster; -1 outside of the part.
    std::ptrdiff_t at(int x, int y) const {
        x -= left;
        y -= top;
        const bool is_inside = x >= 0 && y >= 0 && x < raster.cols && y < raster.rows;
        return is_inside ? static_cast<std::ptrdiff_t>(raster.index(x, y)) : -1;
    }
};

/// Refined vertices as the camera sees them.
struct PaintedSurface::Placed {
    Rows<float, 3> points;   // metres, camera frame
    Rows<float, 3> normals;  // unit
    Rows<float, 2> pixels;
    Eigen::VectorXf light;  // of each picture
};

void PaintedOptions::check() const {
    check_range("PaintedOptions.levels", levels, 0, SubdividedMesh::kMaxLevels);
    check_range("PaintedOptions.finer", finer, 1, 4);
    check_range("PaintedOptions.relief", relief, 0, 1);
    check_range("PaintedOptions.ground", ground, 0, 255);
}

PaintedSurface::PaintedSurface(QuadsIn faces, Paints paints, const PaintedOptions& options)
    : paints_(std::move(paints)),
      options_(options),
      mesh_((options.check(), check(faces, paints_), faces), static_cast<int>(paints_.brightness.size()),
            options.levels) {
    brightness_ = (mesh_.stencils() * paints_.brightness).cwiseMax(0).cwiseMin(1).cast<float>();
    corners_ = refined_corners(mesh_, options.levels, paints_.corners).cast<float>();
    for (Eigen::Index corner = 0; corner < corners_.rows(); ++corner) {
        const int face = mesh_.parent_face()[corner / 4];
        const Paint& paint = paints_.pictures[static_cast<std::size_t>(paints_.picture_of_face[face])];
        corners_(corner, 0) = corners_(corner, 0) * static_cast<float>(paint.cols) - .5f;
        corners_(corner, 1) = (1 - corners_(corner, 1)) * static_cast<float>(paint.rows) - .5f;
    }
    for (const Paint& paint : paints_.pictures) {
        is_open_.push_back(is_see_through(paint));
    }
    for (const bool is_open : {false, true}) {
        std::vector<bool> is_used(static_cast<std::size_t>(mesh_.num_refined()));
        for (Eigen::Index f = 0; f < mesh_.faces().rows(); ++f) {
            const int picture = paints_.picture_of_face[mesh_.parent_face()[f]];
            for (int k = 0; k < 4 && is_open_[static_cast<std::size_t>(picture)] == is_open; ++k) {
                is_used[static_cast<std::size_t>(mesh_.faces()(f, k))] = true;
            }
        }
        for (int vertex = 0; vertex < mesh_.num_refined(); ++vertex) {
            if (is_used[static_cast<std::size_t>(vertex)]) {
                (is_open ? open_ : covering_).push_back(vertex);
            }
        }
    }
}

ColorImage PaintedSurface::draw(const Camera& camera, PointsIn vertices_in_camera, VectorIn light) const {
    camera.check();
    require(vertices_in_camera.rows() == mesh_.stencils().cols(),
            "a painted surface was given another number of vertices than it has");
    require(vertices_in_camera.allFinite(), "a vertex of a painted surface is not finite");
    const int finer = options_.finer;
    const Camera fine{camera.fx * finer,
                      camera.fy * finer,
                      (camera.cx + .5) * finer - .5,
                      (camera.cy + .5) * finer - .5,
                      camera.width * finer,
                      camera.height * finer};
    const auto num_pictures = static_cast<Eigen::Index>(paints_.pictures.size());
    require((light.size() == 0 || light.size() == num_pictures) && light.allFinite(),
            "a painted surface was given light of other pictures than it has");
    Placed placed = place(fine, vertices_in_camera);
    placed.light = Eigen::VectorXf::Ones(num_pictures);
    if (light.size() > 0) {
        placed.light = light.cast<float>();
    }
    Layer covering(fine, placed.pixels, covering_), open(fine, placed.pixels, open_);
    fill(covering, open, placed);
    ColorImage picture{camera.height, camera.width, {}};
    picture.pixels.resize(3 * static_cast<std::size_t>(camera.height) *
                          static_cast<std::size_t>(camera.width));
    cv::parallel_for_({0, camera.height}, [&](const cv::Range& rows) {
        std::uint8_t* level = picture.pixels.data() + std::ptrdiff_t{3} * rows.start * camera.width;
        for (int y = rows.start; y < rows.end; ++y) {
            for (int x = 0; x < camera.width; ++x) {
                const Eigen::Vector3f colour = mean(covering, open, placed, x * finer, y * finer);
                for (int k = 0; k < 3; ++k) {
                    *level++ = static_cast<std::uint8_t>(std::clamp(colour[k] + .5f, 0.f, 255.f));
                }
            }
        }
    });
    return picture;
}

/// Of a pixel whose samples begin at (x, y).
Eigen::Vector3f PaintedSurface::mean(const Layer& covering, const Layer& open, const Placed& placed, int x,
                                     int y) const {
    const int finer = options_.finer, count = finer * finer;
    const std::ptrdiff_t first = covering.at(x, y);
    const int half = first < 0 ? -1 : covering.raster.face[static_cast<std::size_t>(first)];
    Eigen::Vector2f weights = Eigen::Vector2f::Zero();
    bool is_one = half >= 0;  // and can be coloured at once
    for (int k = 0; is_one && k < count; ++k) {
        const int at_x = x + k % finer, at_y = y + k / finer;
        const std::ptrdiff_t at = covering.at(at_x, at_y), before = open.at(at_x, at_y);
        is_one = at >= 0 && covering.raster.face[static_cast<std::size_t>(at)] == half &&
                 (before < 0 || open.raster.face[static_cast<std::size_t>(before)] < 0);
        if (is_one) {
            weights += covering.weights[static_cast<std::size_t>(at)];
        }
    }
    if (is_one) {
        return colour(placed, half, weights / static_cast<float>(count)).head<3>();
    }
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int k = 0; k < count; ++k) {
        sum += sample(covering, open, placed, x + k % finer, y + k / finer);
    }
    return sum / static_cast<float>(count);
}

PaintedSurface::Placed PaintedSurface::place(const Camera& camera, PointsIn vertices_in_camera) const {
    Placed placed{mesh_.positions(vertices_in_camera).cast<float>(),
                  mesh_.normals(vertices_in_camera).cast<float>(),
                  {},
                  {}};
    placed.pixels.resize(placed.points.rows(), 2);
    const Eigen::ArrayXf z = placed.points.col(2).array().max(kNearest);
    placed.pixels.col(0) =
        static_cast<float>(camera.fx) * placed.points.col(0).array() / z + static_cast<float>(camera.cx);
    placed.pixels.col(1) =
        static_cast<float>(camera.fy) * placed.points.col(1).array() / z + static_cast<float>(camera.cy);
    return placed;
}

void PaintedSurface::fill(Layer& covering, Layer& open, const Placed& placed) const {
    for (int f = 0; f < mesh_.faces().rows(); ++f) {
        const int picture = paints_.picture_of_face[mesh_.parent_face()[f]];
        const bool is_open = is_open_[static_cast<std::size_t>(picture)];
        Layer& layer = is_open ? open : covering;
        const Eigen::Vector2f corner_of_part(static_cast<float>(layer.left), static_cast<float>(layer.top));
        for (int half = 0; half < 2; ++half) {
            const std::array<int, 3>& of_quad = kQuadHalves[static_cast<std::size_t>(half)];
            TriangleCorners<float> corners;
            Eigen::Matrix3f points;
            for (std::size_t k = 0; k < 3; ++k) {
                const int vertex = mesh_.faces()(f, of_quad[k]);
                corners[k] = placed.pixels.row(vertex).transpose() - corner_of_part;
                points.col(static_cast<Eigen::Index>(k)) = placed.points.row(vertex);
            }
            const Eigen::Vector3f one = points.col(1) - points.col(0), other = points.col(2) - points.col(0);
            const bool is_away = one.cross(other).dot(points.col(0)) >= 0;
            if (points.row(2).minCoeff() <= kNearest || (is_away && !is_open)) {
                continue;
            }
            const Eigen::Vector3f nearness = points.row(2).cwiseInverse();
            fill_triangle(
                corners, layer.raster.rows, layer.raster.cols,
                [&](int x, int y, const Eigen::Vector3f& weights) {
                    const float depth = 1 / weights.dot(nearness);
                    if (layer.raster.keep_nearer(x, y, 2 * f + half, depth)) {
                        layer.weights[layer.raster.index(x, y)] =
                            depth * weights.cwiseProduct(nearness).tail<2>();
                    }
                },
                kSlack);
        }
    }
}

Eigen::Vector3f PaintedSurface::sample(const Layer& covering, const Layer& open, const Placed& placed, int x,
                                       int y) const {
    Eigen::Vector3f behind = Eigen::Vector3f::Constant(static_cast<float>(options_.ground));
    float depth = std::numeric_limits<float>::infinity();
    if (const std::ptrdiff_t at = covering.at(x, y); at >= 0) {
        depth = covering.raster.depth[static_cast<std::size_t>(at)];
        if (std::isfinite(depth)) {
            behind = colour(placed, covering.raster.face[static_cast<std::size_t>(at)],
                            covering.weights[static_cast<std::size_t>(at)])
                         .head<3>();
        }
    }
    if (const std::ptrdiff_t at = open.at(x, y);
        at >= 0 && open.raster.depth[static_cast<std::size_t>(at)] < depth) {
        const Eigen::Vector4f before = colour(placed, open.raster.face[static_cast<std::size_t>(at)],
                                              open.weights[static_cast<std::size_t>(at)]);
        behind += before[3] / 255 * (before.head<3>() - behind);
    }
    return behind;
}

const std::uint8_t* PaintedSurface::texel(int face, int x, int y) const {
    const int picture = paints_.picture_of_face[mesh_.parent_face()[face]];
    const Paint& paint = paints_.pictures[static_cast<std::size_t>(picture)];
    x = std::clamp(x, 0, paint.cols - 1);
    y = std::clamp(y, 0, paint.rows - 1);
    return paint.pixels.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(paint.cols) +
                                      static_cast<std::size_t>(x));
}

Eigen::Vector4f PaintedSurface::colour(const Placed& placed, int half,
                                       const Eigen::Vector2f& last_weights) const {
    const int face = half / 2;
    const std::array<int, 3>& of_quad = kQuadHalves[static_cast<std::size_t>(half % 2)];
    const Eigen::Vector3f weights(1 - last_weights.sum(), last_weights.x(), last_weights.y());
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    Eigen::Vector2f place = Eigen::Vector2f::Zero();
    float brightness = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const int vertex = mesh_.faces()(face, of_quad[k]);
        const float weight = weights[static_cast<Eigen::Index>(k)];
        normal += weight * placed.normals.row(vertex).transpose();
        place += weight * corners_.row(4 * face + of_quad[k]).transpose();
        brightness += weight * brightness_[vertex];
    }
    const auto relief = static_cast<float>(options_.relief);
    const float lit = std::clamp(normal.normalized().dot(kLamp), 0.f, 1.f);
    const float light = placed.light[paints_.picture_of_face[mesh_.parent_face()[face]]];
    const float shade = light * brightness * (1 - relief * (1 - lit));
    const Eigen::Vector2f low = place.array().floor(), part = place - low;
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (int k = 0; k < 4; ++k) {
        const std::uint8_t* pixel =
            texel(face, static_cast<int>(low.x()) + k % 2, static_cast<int>(low.y()) + k / 2);
        const float share = (k % 2 ? part.x() : 1 - part.x()) * (k / 2 ? part.y() : 1 - part.y());
        sum += share * Eigen::Vector4f(pixel[0], pixel[1], pixel[2], pixel[3]);
    }
    sum.head<3>() *= shade;
    return sum;
}

}  // namespace mimetic
