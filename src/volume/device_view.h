// From a DeviceVolume to what a kernel reads.
#pragma once
#include <algorithm>
#include <cmath>

#include "volume/device_volume.h"
#include "volume/float3.h"
#include "volume/label_bricks.h"
#include "volume/view.h"

namespace chiaro {

inline kernel::FactorView factor_view(const DeviceVolume::Data& volume) {
    if (!volume.factor) return {};
    const ExtinctionFactor& factor = *volume.factor;
    const double rows = std::abs(volume.scale) * factor.rows_per_unit;
    // A gradient is a covector: its axes in the world are those of the voxels per mm.
    const auto row = [&](Vec3 axis) { return float3(rows * volume.geometry.voxel_from_world_vector(axis)); };
    return {factor.entries.data(),
            factor.columns,
            float(factor.index_scale),
            float(factor.index_offset + 0.5),
            float(factor.columns - 1),
            float(factor.rows - 1),
            row({1, 0, 0}),
            row({0, 1, 0}),
            row({0, 0, 1})};
}

inline kernel::LabelView label_view(const LabelBricks* labels) {
    if (!labels) return {};
    return {reinterpret_cast<const std::uint8_t*>(labels->distance.data()),
            reinterpret_cast<const std::uint8_t*>(labels->share.data()),
            reinterpret_cast<const std::uint32_t*>(labels->tint.data()), labels->cells.data()};
}

template <class Voxel>
kernel::MixtureView<Voxel> mixture_view(const DeviceVolume::Data& volume) {
    if (!volume.mixture) return {};
    return {static_cast<const kernel::ChannelView<Voxel>*>(volume.mixture->channel_views.get()), volume.mixture->count,
            label_view(volume.mixture->labels.get()), volume.mixture->own_colors};
}

/// `Voxel` is the stored type.
template <class Voxel>
kernel::VolumeView<Voxel> view_of(const DeviceVolume::Data& volume) {
    const auto [nx, ny, nz] = volume.dimensions;
    const SplineCoding& spline = volume.spline;
    const auto& reach = volume.normal_reach;
    const auto* coefficients = reinterpret_cast<const Voxel*>(volume.coefficients.data());
    return {reinterpret_cast<const Voxel*>(volume.bricks.data()),
            brick_count(nx),
            brick_count(ny),
            {float(nx - 1), float(ny - 1), float(nz - 1)},
            std::max(nx - 2, 0),
            std::max(ny - 2, 0),
            std::max(nz - 2, 0),
            {coefficients, spline.base, spline.scale, spline.least, {reach[0], reach[1], reach[2]}},
            factor_view(volume),
            mixture_view<Voxel>(volume)};
}

/// Calls f with a value of the type that the voxels are stored as.
template <class Function>
decltype(auto) with_stored_voxel(const DeviceVolume::Data& volume, Function&& f) {
    switch (volume.stored) {
        case VoxelType::u8:
            return f(std::uint8_t{});
        case VoxelType::u16:
            return f(std::uint16_t{});
        default:
            return f(float{});
    }
}

/// Calls visit(number, voxel) for the first slices of a brick's numbers, border included: `voxel` is the one whose it
/// is or, beyond the volume, the nearest; x fastest.
template <class Number, class Visit>
void for_each_of_brick(const std::array<int, 3>& n, const std::array<int, 3>& brick, int slices, Number* numbers,
                       const Visit& visit) {
    const auto voxel = [&](int i, std::size_t axis) {
        return std::size_t(std::clamp(brick[axis] * brick_edge - brick_before + i, 0, n[axis] - 1));
    };
    for (int z = 0; z < slices; ++z)
        for (int y = 0; y < brick_row; ++y) {
            const std::size_t row = (voxel(z, 2) * std::size_t(n[1]) + voxel(y, 1)) * std::size_t(n[0]);
            for (int x = 0; x < brick_row; ++x) visit(numbers[z * brick_slice + y * brick_row + x], row + voxel(x, 0));
        }
}

/// Calls visit(x, count, voxels) for the pieces of row (y, z), each of which lies side by side in a brick.
template <class Voxel, class Visit>
void for_each_run(const DeviceVolume::Data& volume, int y, int z, const Visit& visit) {
    const auto* voxels = reinterpret_cast<const Voxel*>(volume.bricks.data());
    const int n = volume.dimensions[0];
    for (int x = 0, end = 0; end < n; x = end) {
        end = x + brick_edge + 1 < n ? x + brick_edge : n;  // the last voxel is the border of the last brick
        visit(x, end - x, voxels + voxel_index(volume, x, y, z));
    }
}

}  // namespace chiaro

namespace chiaro::kernel {

template <class Views, class Voxel>
void swap_pointers(Views& views, VolumeView<Voxel>& view) {
    views.to_device_pointers(view.voxels, view.spline.coefficients, view.factor.entries);
}

}  // namespace chiaro::kernel
