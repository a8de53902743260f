// What ranks that are processes are measured by: light of a block, and its part of a picture.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>

#include "rank_processes.h"
#include "rank_threads.h"

namespace chiaro::testing {

inline Volume float_tubes(int size) {
    Progress progress;
    const Volume bytes = make_sample("tubes", size, progress);
    Volume floats = make_volume(bytes.dimensions, VoxelType::f32);
    floats.geometry = bytes.geometry;
    const auto from = bytes.as<std::uint8_t>();
    std::copy(from.begin(), from.end(), floats.as<float>().begin());
    return floats;
}

/// Cuts the longest axis of the largest block in two until there are so many.
inline std::vector<Cut> even_cuts(const std::array<int, 3>& whole, int ranks) {
    std::vector<Cut> cuts;
    while (int(cuts.size()) + 1 < ranks) {
        const std::vector<OwnVoxels> blocks = cut_up(whole, cuts);
        Cut next{0, 0, 0};
        std::int64_t most = 0;
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const auto& [first, end] = blocks[b];
            const std::array<int, 3> n{end[0] - first[0], end[1] - first[1], end[2] - first[2]};
            const std::int64_t voxels = std::int64_t(n[0]) * n[1] * n[2];
            if (voxels <= most) continue;
            most = voxels;
            const int axis = n[2] >= n[1] && n[2] >= n[0] ? 2 : n[1] >= n[0] ? 1 : 0;
            next = {int(b), axis, first[std::size_t(axis)] + n[std::size_t(axis)] / 2};
        }
        cuts.push_back(next);
    }
    return cuts;
}

/// Each rank by one thread. The voxels of a block are there before, as VTK's are.
inline std::vector<RankCost> costs_of(const Volume& whole, const IlluminationSettings& settings, int ranks,
                                      int ghosts) {
    const std::vector<OwnVoxels> blocks = cut_up(whole.dimensions, even_cuts(whole.dimensions, ranks));
    CameraSettings seen;
    seen.azimuth_deg = 28, seen.elevation_deg = 19;
    const Camera camera = make_camera(seen, whole.geometry, whole.dimensions);
    TransferFunction tf;
    tf.points = {
        {20, {0.9, 0.5, 0.2}, 0}, {60, {0.9, 0.6, 0.3}, 0.02}, {110, {0.7, 0.6, 0.6}, 0.3}, {255, {0.3, 0.7, 1}, 0.9}};
    return in_processes(ranks, [&](const std::shared_ptr<ProcessExchange>& exchange, RankMeter& meter) {
        Device device = Device::cpu(1);
        if (ranks > 1) device.ranks = exchange;
        Volume block = block_of(whole, blocks[std::size_t(exchange->rank())], ghosts);
        if (ranks == 1) block.placement.reset();
        meter.start(double(block.voxels.size()));
        Progress progress;
        const Medium medium = classify(upload(device, block, progress), tf, {});
        IlluminationField field;
        illuminate(
            device, medium, Prepared(), {}, settings, [&](IlluminationField finer) { field = std::move(finer); },
            progress);
        Frame frame(480, 360);
        raycast(device, medium, field, {}, camera, {.early_termination = 0}, frame, progress);
        meter.end(double(field.bytes()));
    });
}

}  // namespace chiaro::testing
