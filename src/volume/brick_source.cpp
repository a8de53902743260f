#include <chiaro/brick_source.h>

#include <algorithm>
#include <cstring>

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
    volume.moments = header.moments;
    volume.notes = header.notes, volume.key_values = header.key_values;
    return volume;
}

/// The voxels of one piece to their place in the level's volume, some slices at a time.
void read_piece(const BrickSource& source, int level, const std::array<int, 3>& at, Volume& volume) {
    constexpr std::size_t most = 4 << 20;
    const std::array<int, 3>& n = volume.dimensions;
    VoxelBox box{{}, source.piece(level)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.first[axis] = at[axis] * box.size[axis];
        box.size[axis] = std::min(box.size[axis], n[axis] - box.first[axis]);
    }
    const int end = box.first[2] + box.size[2];
    const std::size_t bytes = size_of(volume.type), row = std::size_t(box.size[0]) * bytes,
                      slice = row * std::size_t(box.size[1]);
    const bool is_in_place = box.size[0] == n[0] && box.size[1] == n[1];
    const int slices =
        is_in_place ? box.size[2] : int(std::clamp<std::size_t>(most / slice, 1, std::size_t(box.size[2])));
    const auto place = [&](int y, int z) {
        return volume.voxels.data() +
               ((std::size_t(z) * std::size_t(n[1]) + std::size_t(y)) * std::size_t(n[0]) + std::size_t(box.first[0])) *
                   bytes;
    };
    std::vector<std::byte> voxels(is_in_place ? 0 : slice * std::size_t(slices));
    for (int z = box.first[2]; z < end; z += slices) {
        const VoxelBox part{{box.first[0], box.first[1], z}, {box.size[0], box.size[1], std::min(slices, end - z)}};
        if (is_in_place) {
            source.read(level, part, place(0, z));
            continue;
        }
        source.read(level, part, voxels.data());
        const std::byte* from = voxels.data();
        for (int k = z; k < z + part.size[2]; ++k)
            for (int y = 0; y < box.size[1]; ++y, from += row) std::memcpy(place(box.first[1] + y, k), from, row);
    }
}

}  // namespace

std::array<int, 3> BrickSource::piece(int level) const {
    const auto& n = levels()[std::size_t(level)].dimensions;
    return {n[0], n[1], 1};
}

std::size_t BrickSource::keep_decoded(std::size_t) const { return 0; }
bool BrickSource::is_far() const { return false; }

BrickSource::BrickSource(Volume header, std::vector<SourceLevel> levels)
    : header_(std::move(header)), levels_(std::move(levels)) {}
BrickSource::~BrickSource() = default;

int small_level(const BrickSource& source, int edge) {
    const auto& levels = source.levels();
    const auto is_small = [edge](const SourceLevel& level) { return std::ranges::max(level.dimensions) <= edge; };
    return int(std::find_if(levels.begin(), levels.end() - 1, is_small) - levels.begin());
}

Volume read_level(const BrickSource& source, int level, Progress& progress) {
    Volume volume = volume_of(source, level);
    const std::array<int, 3> n = volume.dimensions, piece = source.piece(level);
    volume.voxels = VoxelBuffer(volume.voxel_count() * size_of(volume.type));
    std::array<int, 3> count{};
    for (std::size_t axis = 0; axis < 3; ++axis) count[axis] = (n[axis] - 1) / piece[axis] + 1;
    const std::int64_t pieces = std::int64_t(count[0]) * count[1] * count[2];
    parallel_for(usable_threads(), pieces, 1, "read", progress, [&](std::int64_t p, std::int64_t end) {
        for (; p < end; ++p)
            read_piece(source, level, {int(p % count[0]), int(p / count[0] % count[1]), int(p / count[0] / count[1])},
                       volume);
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
