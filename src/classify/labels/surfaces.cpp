// Isosurfaces of a volume in which labels lie.
#include <chiaro/error.h>

#include <algorithm>

#include "classify/labels/labelled.h"
#include "classify/largest.h"
#include "core/threads.h"
#include "volume/edited.h"

namespace chiaro {
namespace {

/// What voxels can be stored as.
std::pair<float, float> storable(const DeviceVolume::Data& volume) {
    constexpr float most = 3e38f;
    if (volume.stored == VoxelType::f32) return {-most, most};
    return {0.0f, volume.stored == VoxelType::u8 ? 255.0f : 65535.0f};
}

/// Of each voxel whether labels hide it, x fastest.
std::vector<std::uint8_t> hidden_voxels(const LabelBricks& labels, const DeviceVolume::Data& volume) {
    const auto* const distance = reinterpret_cast<const std::uint8_t*>(labels.distance.data());
    const auto [nx, ny, nz] = volume.dimensions;
    std::vector<std::uint8_t> hidden(std::size_t(nx) * std::size_t(ny) * std::size_t(nz));
    parallel_for(volume.device.threads, nz, 1, [&](std::int64_t z, std::int64_t) {
        std::uint8_t* to = &hidden[std::size_t(z) * std::size_t(ny) * std::size_t(nx)];
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) *to++ = distance[voxel_index(volume, x, y, int(z))] < LabelCoding::middle;
    });
    return hidden;
}

/// The volume of which hidden voxels lie outside all surfaces, by so little that these pass beyond the labels' borders.
DeviceVolume without_hidden(const Medium::Data& medium, const LabelBricks& labels) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const auto lower = [](const IsoSurface& a, const IsoSurface& b) { return a.value < b.value; };
    const auto& surfaces = medium.shape.iso;
    const double lowest = std::min_element(surfaces.begin(), surfaces.end(), lower)->value;
    const auto outside = values_outside(volume, lowest, storable(volume));
    if (!outside)
        throw Error(ErrorCode::usage,
                    "labels: every value that a voxel can have lies within the lowest isosurface (--iso), so nothing "
                    "can be hidden");
    return edited(
        medium.volume, hidden_voxels(labels, volume),
        [&](float stored) { return std::clamp(stored, outside->first, outside->second); }, volume.bounds);
}

}  // namespace

Medium with_labelled_surfaces(const Device& device, const Medium::Data& medium,
                              std::shared_ptr<const LabelBricks> labels, const Progress& progress) {
    if (labels->share.size())
        throw Error(ErrorCode::usage,
                    "labels: an opacity between 0 and 1 goes with --mode dvr, additive, mip and minip: an isosurface "
                    "has one of its own (--iso VALUE,COLOUR@OPACITY)");
    auto data = std::make_shared<Medium::Data>();
    data->volume = labels->distance.size() ? without_hidden(medium, *labels) : medium.volume;
    data->table = medium.table, data->shape = medium.shape;
    const CellRanges& cells = data->volume.data().cells;
    const RangeTest is_crossed = crossed_range(data->volume.data(), data->shape.iso);
    data->cells = make_occupancy(cells, std::cref(is_crossed), device.threads, progress);
    data->find_occupied_fraction();
    data->surface_labels = std::move(labels);
    return Medium(std::move(data));
}

}  // namespace chiaro
