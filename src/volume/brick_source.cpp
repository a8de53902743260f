#include <chiaro/brick_source.h>

#include <atomic>

#include "core/threads.h"

namespace chiaro {
namespace {

/// The source's header for a level's volume, which owns its voxels.
Volume volume_of(const BrickSource& source, int level) {
    const Volume& header = source.header();
    Volume volume;
    volume.dimensions = source.levels()[std::size_t(level)].dimensions;
    volume.geometry = source.levels()[std::size_t(level)].geometry;
    volume.type = header.type;
    volume.slope = header.slope, volume.intercept = header.intercept;
    volume.source = header.source, volume.format = header.format, volume.modality = header.modality;
    volume.notes = header.notes, volume.key_values = header.key_values;
    return volume;
}

}  // namespace

BrickSource::BrickSource(Volume header, std::vector<SourceLevel> levels)
    : header_(std::move(header)), levels_(std::move(levels)) {}
BrickSource::~BrickSource() = default;

Volume read_level(const BrickSource& source, int level, Progress& progress) {
    Volume volume = volume_of(source, level);
    const auto [nx, ny, nz] = volume.dimensions;
    const std::size_t slice = std::size_t(nx) * ny * size_of(volume.type);
    volume.voxels = VoxelBuffer(slice * nz);
    std::byte* voxels = volume.voxels.data();
    const std::array<int, 3> size{nx, ny, 1};
    parallel_for(usable_threads(), nz, 1, "read", progress, [&](std::int64_t z, std::int64_t end) {
        for (; z < end; ++z) source.read(level, {{0, 0, int(z)}, size}, voxels + std::size_t(z) * slice);
    });
    progress.check();
    return volume;
}

double whole_volume_bytes(const std::array<int, 3>& dimensions, VoxelType type) {
    // Bricks with their border twice, of values and of a spline's coefficients; cells' ranges, occupancy, light:
    // 3.3 bytes a voxel of sample:shells:512, which are 8 bits (with --lighting spao).
    const double a_voxel = 2.7 * double(size_of(type)) + 0.7;
    return a_voxel * dimensions[0] * dimensions[1] * dimensions[2];
}

}  // namespace chiaro
