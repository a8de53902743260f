#include <chiaro/error.h>
#include <chiaro/slice.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/threads.h"
#include "volume/part.h"
#include "volume/reader.h"

namespace chiaro {
namespace {

constexpr double max_pixels = 0x1p26;

bool is_finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const SlicePlane& plane) {
    if (plane.width < 1 || plane.height < 1 || double(plane.width) * plane.height > max_pixels)
        throw Error(ErrorCode::usage, "slice: must have 1 to 67108864 pixels");
    if (!is_finite(plane.at(0, 0)) || !is_finite(plane.at(plane.width, plane.height)))
        throw Error(ErrorCode::usage, "slice: its plane must be of finite numbers");
}

}  // namespace

Slice slice(const DeviceVolume& volume, const SlicePlane& plane, SliceSampling sampling) {
    check(plane);
    const DeviceVolume::Data& data = volume.data();
    const Geometry& geometry = data.geometry;
    const Vec3 right = geometry.voxel_from_world_vector(plane.right_mm);
    Slice slice{plane.width, plane.height, std::vector<double>(std::size_t(plane.width) * plane.height)};
    with_stored_voxel(data, [&](auto voxel) {
        const Reader<decltype(voxel)> reader{data};
        parallel_for(data.device.threads, plane.height, 8, [&](std::int64_t begin, std::int64_t end) {
            for (auto row = begin; row < end; ++row) {
                const Vec3 first = geometry.voxel_from_world(plane.at(0, double(row)));
                double* out = &slice.values[std::size_t(row) * plane.width];
                for (int column = 0; column < plane.width; ++column) {
                    const Vec3 p = first + double(column) * right;
                    out[column] = !reader.holds(p)                     ? std::numeric_limits<double>::quiet_NaN()
                                  : sampling == SliceSampling::nearest ? reader.nearest(p)
                                                                       : reader.linear(p);
                }
            }
        });
    });
    return slice;
}

namespace {

constexpr double max_part = 1 << 24;  // voxels that are read at a time

/// Of a plane `columns` of its pixels' columns from one on, and `rows` of its rows.
SlicePlane part_of_plane(SlicePlane plane, int column, int columns, int row, int rows) {
    plane.centre_mm = plane.at(column + 0.5 * (columns - 1), row + 0.5 * (rows - 1));
    plane.width = columns, plane.height = rows;
    return plane;
}

class SourceSlicer {
public:
    SourceSlicer(const BrickSource& source, const DeviceVolume& whole, int level, SliceSampling sampling,
                 Progress& progress)
        : source_(source), whole_(whole), level_(level), sampling_(sampling), progress_(progress) {}

    /// Into the rows of a picture, `stride` apart.
    void draw(const SlicePlane& plane, double* out, int stride) const {
        progress_.check();
        const SourceLevel& grid = source_.levels()[std::size_t(level_)];
        Vec3 low = grid.geometry.voxel_from_world(plane.at(0, 0)), high = low;
        for (const auto& [column, row] : {std::pair{0, 1}, {1, 0}, {1, 1}}) {
            const Vec3 p =
                grid.geometry.voxel_from_world(plane.at(column * (plane.width - 1), row * (plane.height - 1)));
            for (int axis = 0; axis < 3; ++axis)
                low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
        }
        const VoxelBox box = box_around(grid, low, high);
        if (voxels_in(box) == 0) return;
        if (voxels_in(box) > max_part && plane.width * plane.height > 1) return draw_halves(plane, out, stride);
        const Slice part = slice(part_of(source_, level_, box, whole_), plane, sampling_);
        for (int row = 0; row < plane.height; ++row)
            std::copy_n(&part.values[std::size_t(row) * plane.width], plane.width, out + std::ptrdiff_t(row) * stride);
    }

private:
    void draw_halves(const SlicePlane& plane, double* out, int stride) const {
        if (const int half = plane.width / 2; plane.width >= plane.height) {
            draw(part_of_plane(plane, 0, half, 0, plane.height), out, stride);
            draw(part_of_plane(plane, half, plane.width - half, 0, plane.height), out + half, stride);
        } else {
            const int above = plane.height / 2;
            draw(part_of_plane(plane, 0, plane.width, 0, above), out, stride);
            draw(part_of_plane(plane, 0, plane.width, above, plane.height - above),
                 out + std::ptrdiff_t(above) * stride, stride);
        }
    }

    const BrickSource& source_;
    const DeviceVolume& whole_;
    int level_;
    SliceSampling sampling_;
    Progress& progress_;
};

/// The coarsest whose voxels are nowhere larger than a pixel.
int level_of_pixels(const BrickSource& source, const SlicePlane& plane) {
    const double pixel = 1 + 1e-6;
    int level = 0;
    for (const SourceLevel& grid : source.levels()) {
        const Vec3 right = grid.geometry.voxel_from_world_vector(plane.right_mm),
                   down = grid.geometry.voxel_from_world_vector(plane.down_mm);
        if (length(right) * pixel < 1 || length(down) * pixel < 1) break;
        level = int(&grid - source.levels().data());
    }
    return level;
}

}  // namespace

Slice slice(const BrickSource& source, const DeviceVolume& whole, const SlicePlane& plane, SliceSampling sampling,
            bool finest, Progress& progress) {
    check(plane);
    const int level = finest ? 0 : level_of_pixels(source, plane);
    Slice slice{plane.width, plane.height,
                std::vector<double>(std::size_t(plane.width) * plane.height, std::numeric_limits<double>::quiet_NaN())};
    SourceSlicer(source, whole, level, sampling, progress).draw(plane, slice.values.data(), plane.width);
    return slice;
}

std::vector<std::uint16_t> slice(const LabelVolume& labels, const DeviceVolume& volume, const SlicePlane& plane) {
    check(plane);
    const DeviceVolume::Data& data = volume.data();
    const LabelPlacement placed = place_labels(labels, data.dimensions, data.geometry);
    const auto in_labels = [&](Vec3 p) { return p.x * placed.axes[0] + p.y * placed.axes[1] + p.z * placed.axes[2]; };
    const Vec3 right = in_labels(data.geometry.voxel_from_world_vector(plane.right_mm));
    const auto numbers = labels.numbers();
    const auto [nx, ny, nz] = labels.dimensions;
    std::vector<std::uint16_t> out(std::size_t(plane.width) * plane.height);
    parallel_for(data.device.threads, plane.height, 8, [&](std::int64_t begin, std::int64_t end) {
        for (auto row = begin; row < end; ++row) {
            const Vec3 first = placed.offset + in_labels(data.geometry.voxel_from_world(plane.at(0, double(row))));
            for (int column = 0; column < plane.width; ++column) {
                const Vec3 p = first + double(column) * right;
                const double x = std::floor(p.x + 0.5), y = std::floor(p.y + 0.5), z = std::floor(p.z + 0.5);
                if (x < 0 || x >= nx || y < 0 || y >= ny || z < 0 || z >= nz) continue;
                out[std::size_t(row) * plane.width + column] =
                    numbers[(std::size_t(z) * std::size_t(ny) + std::size_t(y)) * std::size_t(nx) + std::size_t(x)];
            }
        }
    });
    return out;
}

}  // namespace chiaro
