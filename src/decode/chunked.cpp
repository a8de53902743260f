#include "decode/chunked.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace chiaro::decode {
namespace {

/// One component of a chunk to its place among the volume's voxels.
void place(const ChunkedLevel& level, const std::array<int, 3>& chunk, int component, const std::byte* from,
           Volume& volume) {
    const std::size_t bytes = size_of(volume.type), voxel_bytes = bytes * std::size_t(volume.components);
    std::array<std::int64_t, 3> first{}, size{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = std::int64_t(chunk[axis]) * level.chunk[axis];
        size[axis] = std::min<std::int64_t>(level.chunk[axis], level.dimensions[axis] - first[axis]);
    }
    for (std::int64_t z = 0; z < size[2]; ++z)
        for (std::int64_t y = 0; y < size[1]; ++y) {
            const std::byte* row = from + std::size_t((z * level.chunk[1] + y) * level.chunk[0]) * bytes;
            const std::int64_t line = (first[2] + z) * level.dimensions[1] + first[1] + y;
            std::byte* to = volume.voxels.data() + std::size_t(line * level.dimensions[0] + first[0]) * voxel_bytes +
                            std::size_t(component) * bytes;
            if (volume.components == 1)
                std::memcpy(to, row, std::size_t(size[0]) * bytes);
            else
                for (std::int64_t x = 0; x < size[0]; ++x, to += voxel_bytes, row += bytes) std::memcpy(to, row, bytes);
        }
}

}  // namespace

int grown_edge(int edge, int border) {
    constexpr int least = 32;
    return edge * std::min((least - 1) / edge + 1, (border - 1) / edge + 1);
}

Volume read_whole(ChunkedFile& file, Output& output) {
    const ChunkedLevel& level = file.levels().front();
    const Volume& header = file.header();
    Volume volume;
    volume.dimensions = header.dimensions, volume.type = header.type, volume.components = header.components;
    volume.component_infos = header.component_infos;
    volume.slope = header.slope, volume.intercept = header.intercept, volume.modality = header.modality;
    volume.geometry = header.geometry, volume.moments = header.moments;
    volume.format = header.format, volume.notes = header.notes, volume.key_values = header.key_values;
    output.allocate(volume);
    std::vector<std::byte> voxels(level.chunk_voxels() * size_of(volume.type));
    const auto [nx, ny, nz] = level.chunks();
    const std::uint64_t expected = std::uint64_t(nx) * std::uint64_t(ny) * std::uint64_t(nz);
    std::uint64_t done = 0, written = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                bool is_written = false;
                for (int component = 0; component < volume.components; ++component) {
                    is_written |= file.read(0, {x, y, z}, component, voxels);
                    place(level, {x, y, z}, component, voxels.data(), volume);
                }
                written += is_written;
                output.progress(double(++done) / double(expected));
            }
    if (written < expected)
        volume.notes.push_back(
            fmt::format("{} of {} chunks were never written; they hold the fill value", expected - written, expected));
    return volume;
}

}  // namespace chiaro::decode
