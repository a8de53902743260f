#include "raycast/bounds.h"

#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

constexpr int block_cells = 4;
constexpr int block_voxels = block_cells * cell_edge;  ///< voxels
constexpr float nowhere_mm = 1e30f;

/// Which blocks hold a cell that does; x fastest.
struct BlockGrid {
    std::array<int, 3> count;
    std::vector<char> occupied;

    explicit BlockGrid(const Medium::Data& medium) {
        const auto cells = medium.volume.data().cells.count;
        for (int a = 0; a < 3; ++a) count[a] = (cells[a] + block_cells - 1) / block_cells;
        occupied.assign(std::size_t(count[0]) * count[1] * count[2], 0);
        for (int z = 0; z < cells[2]; ++z)
            for (int y = 0; y < cells[1]; ++y) {
                const std::uint8_t* row = &medium.cells[(std::size_t(z) * cells[1] + y) * cells[0]];
                char* blocks = &occupied[index({0, y / block_cells, z / block_cells})];
                for (int x = 0; x < cells[0]; ++x) blocks[x / block_cells] |= char(row[x] & 1);
            }
    }

    std::size_t index(std::array<int, 3> b) const { return (std::size_t(b[2]) * count[1] + b[1]) * count[0] + b[0]; }
    /// Beyond the volume nothing is.
    bool at(std::array<int, 3> b) const {
        for (int a = 0; a < 3; ++a)
            if (b[a] < 0 || b[a] >= count[a]) return false;
        return occupied[index(b)];
    }
};

/// Rows of the inverse of the matrix with columns a, b, c.
std::array<std::array<double, 3>, 3> inverse(kernel::Float3 a, kernel::Float3 b, kernel::Float3 c) {
    const Vec3 u{a.x, a.y, a.z}, v{b.x, b.y, b.z}, w{c.x, c.y, c.z};
    const auto cross = [](Vec3 p, Vec3 q) {
        return Vec3{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
    };
    const double scale = 1 / dot(u, cross(v, w));
    const auto row = [&](Vec3 p) { return std::array{scale * p.x, scale * p.y, scale * p.z}; };
    return {row(cross(v, w)), row(cross(w, u)), row(cross(u, v))};
}

float component(kernel::Float3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// The rays of one layer of a tile, by component.
struct TileRays {
    static constexpr int count = kernel::tile_edge * kernel::tile_edge;
    std::array<std::array<float, count>, 3> origin, direction;

    TileRays(const kernel::CameraView& camera, kernel::Tile tile, kernel::SubPixel offset) {
        for (int i = 0; i < count; ++i) {
            const int x = tile.x0 + i % kernel::tile_edge, y = tile.y0 + i / kernel::tile_edge;
            const auto ray = camera.ray(float(x) + offset.x, float(y) + offset.y);
            origin[0][i] = ray.origin.x, origin[1][i] = ray.origin.y, origin[2][i] = ray.origin.z;
            direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y, direction[2][i] = ray.direction.z;
        }
    }
};

}  // namespace

BoundingGeometry::BoundingGeometry(const Medium::Data& medium, const kernel::CameraView& camera)
    : camera_(camera),
      camera_from_voxel_(inverse(camera.right, camera.up, camera.forward)),
      tiles_x_((int(camera.width) + kernel::tile_edge - 1) / kernel::tile_edge),
      tiles_y_((int(camera.height) + kernel::tile_edge - 1) / kernel::tile_edge),
      faces_of_tile_(std::size_t(tiles_x_) * tiles_y_) {
    add_faces(medium);
    bin();
}

/// Faces side by side along a row become one.
void BoundingGeometry::add_faces(const Medium::Data& medium) {
    const BlockGrid blocks(medium);
    for (int axis = 0; axis < 3; ++axis) {
        const int along = axis == 0 ? 1 : 0, across = 3 - axis - along;
        for (const bool high : {false, true}) {
            std::array<int, 3> b;
            const auto is_face = [&] {
                std::array<int, 3> neighbour = b;
                neighbour[axis] += high ? 1 : -1;
                return blocks.at(b) && !blocks.at(neighbour);
            };
            for (b[axis] = 0; b[axis] < blocks.count[axis]; ++b[axis])
                for (b[across] = 0; b[across] < blocks.count[across]; ++b[across])
                    for (b[along] = 0; b[along] < blocks.count[along]; ++b[along]) {
                        if (!is_face()) continue;
                        const std::array<int, 3> first = b;
                        while (is_face()) ++b[along];
                        std::array<int, 3> last = b;
                        --last[along];
                        add_face(axis, high, first, last, medium);
                    }
        }
    }
}

void BoundingGeometry::add_face(int axis, bool at_high_side, std::array<int, 3> first, std::array<int, 3> last,
                                const Medium::Data& medium) {
    const auto& n = medium.volume.data().dimensions;
    // An axis of one voxel is one voxel thick.
    const auto low = [&](int a, int block) { return n[a] == 1 ? -0.5f : float(block * block_voxels); };
    const auto high = [&](int a, int block) {
        return n[a] == 1 ? 0.5f : float(std::min((block + 1) * block_voxels, n[a] - 1));
    };
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Face face{axis,
              at_high_side ? high(axis, last[axis]) : low(axis, first[axis]),
              {low(u, first[u]), low(v, first[v])},
              {high(u, last[u]), high(v, last[v])},
              false,
              0,
              0,
              0,
              0};
    const float towards =
        camera_.orthographic ? component(camera_.forward, axis) : face.at - component(camera_.eye, axis);
    if (towards == 0) return;  // seen from its edge: its neighbours are seen
    face.entered = (towards > 0) != at_high_side;
    if (find_pixels(face)) faces_.push_back(face);
}

/// A pixel more on every side, for the rays beside the pixels' middles. A face that reaches behind the eye may be
/// anywhere.
bool BoundingGeometry::find_pixels(Face& face) const {
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    int behind = 0;
    for (int corner = 0; corner < 4; ++corner) {
        Vec3 p;
        p[face.axis] = face.at;
        p[(face.axis + 1) % 3] = corner & 1 ? face.high[0] : face.low[0];
        p[(face.axis + 2) % 3] = corner & 2 ? face.high[1] : face.low[1];
        p = p - Vec3{camera_.eye.x, camera_.eye.y, camera_.eye.z};
        std::array<double, 3> q;  // right, up, forward
        for (int a = 0; a < 3; ++a)
            q[a] = camera_from_voxel_[a][0] * p.x + camera_from_voxel_[a][1] * p.y + camera_from_voxel_[a][2] * p.z;
        behind += q[2] <= 1e-6 * (std::abs(q[0]) + std::abs(q[1]));
        const double scale = camera_.orthographic ? 1 : 1 / q[2];
        const double column = ((scale * q[0] - camera_.centre_x) / camera_.half_width + 1) / 2 * camera_.width;
        const double row = (1 - (scale * q[1] - camera_.centre_y) / camera_.half_height) / 2 * camera_.height;
        left = std::min(left, column), right = std::max(right, column);
        top = std::min(top, row), bottom = std::max(bottom, row);
    }
    if (behind == 4) return false;
    const int width = int(camera_.width), height = int(camera_.height);
    face.x0 = 0, face.y0 = 0, face.x1 = width, face.y1 = height;
    if (behind > 0 && !camera_.orthographic) return true;
    face.x0 = int(std::clamp(std::floor(left) - 1, 0.0, double(width)));
    face.x1 = int(std::clamp(std::ceil(right) + 1, 0.0, double(width)));
    face.y0 = int(std::clamp(std::floor(top) - 1, 0.0, double(height)));
    face.y1 = int(std::clamp(std::ceil(bottom) + 1, 0.0, double(height)));
    return face.x0 < face.x1 && face.y0 < face.y1;
}

void BoundingGeometry::bin() {
    constexpr int edge = kernel::tile_edge;
    for (int f = 0; f < int(faces_.size()); ++f)
        for (int y = faces_[f].y0 / edge; y <= (faces_[f].y1 - 1) / edge; ++y)
            for (int x = faces_[f].x0 / edge; x <= (faces_[f].x1 - 1) / edge; ++x)
                faces_of_tile_[std::size_t(y) * tiles_x_ + x].push_back(f);
}

void BoundingGeometry::rasterise(kernel::Tile tile, int rays_per_pixel, TileBounds& bounds) const {
    constexpr int edge = kernel::tile_edge;
    const std::size_t all = std::size_t(rays_per_pixel) * TileRays::count;
    bounds.near_mm.assign(all, nowhere_mm);
    bounds.exit_mm.assign(all, nowhere_mm);
    bounds.far_mm.assign(all, -nowhere_mm);
    const auto& faces = faces_of_tile_[std::size_t(tile.y0 / edge) * tiles_x_ + tile.x0 / edge];
    if (faces.empty()) return;
    for (int layer = 0; layer < rays_per_pixel; ++layer) {
        const TileRays rays(camera_, tile, kernel::sub_pixel(layer, rays_per_pixel));
        float *near = &bounds.near_mm[std::size_t(layer) * TileRays::count],
              *exit = &bounds.exit_mm[std::size_t(layer) * TileRays::count],
              *far = &bounds.far_mm[std::size_t(layer) * TileRays::count];
        for (const int f : faces) {
            const Face& face = faces_[f];
            constexpr float slack = 1e-2f;  // voxels: no ray slips between two faces
            const int u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
            const float u0 = face.low[0] - slack, u1 = face.high[0] + slack, v0 = face.low[1] - slack,
                        v1 = face.high[1] + slack;
            float* first = face.entered ? near : exit;
            const int x0 = std::max(face.x0, tile.x0) - tile.x0, x1 = std::min(face.x1, tile.x1) - tile.x0;
            for (int y = std::max(face.y0, tile.y0) - tile.y0; y < std::min(face.y1, tile.y1) - tile.y0; ++y)
                for (int i = y * edge + x0; i < y * edge + x1; ++i) {
                    const float t = (face.at - rays.origin[face.axis][i]) / rays.direction[face.axis][i];
                    const float pu = rays.origin[u][i] + t * rays.direction[u][i];
                    const float pv = rays.origin[v][i] + t * rays.direction[v][i];
                    const bool met = (t >= 0) & (pu >= u0) & (pu <= u1) & (pv >= v0) & (pv <= v1);
                    first[i] = met && t < first[i] ? t : first[i];
                    far[i] = met && t > far[i] ? t : far[i];
                }
        }
        for (int i = 0; i < TileRays::count; ++i) near[i] = exit[i] < near[i] ? 0 : near[i];
    }
}

}  // namespace chiaro
