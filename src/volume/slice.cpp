#include <chiaro/error.h>
#include <chiaro/slice.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/threads.h"
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
