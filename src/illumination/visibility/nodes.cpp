#include "illumination/visibility/nodes.h"

#include "core/threads.h"
#include "illumination/sh/basis.h"
#include "illumination/visibility/launch.h"

namespace chiaro {

float VisibilityNodes::step(int coefficient) const {
    if (storage != ShStorage::u8) return 1;
    return float(coefficient_bounds[std::size_t(coefficient)] / (coefficient == 0 ? 255 : 127));
}

VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings, bool displaced) {
    const std::size_t bytes_per_node = std::size_t(coefficients) << int(settings.storage);
    return {grid,
            settings.storage,
            settings.window,
            coefficients,
            VoxelBuffer(grid.size() * bytes_per_node),
            displaced ? VoxelBuffer(grid.size() * sizeof(kernel::NodeSurface)) : VoxelBuffer()};
}

kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field, const float* opacity, const float* shares) {
    const auto [nx, ny, nz] = nodes.grid.count;
    kernel::KeepKernel keep{field,
                            opacity,
                            shares,
                            nodes.harmonics.data(),
                            reinterpret_cast<kernel::NodeSurface*>(nodes.surfaces.data()),
                            kernel::Stored(nodes.storage),
                            nodes.coefficients,
                            {nx, ny, nz},
                            {}};
    for (int c = 0; c < max_coefficients; ++c) keep.steps[c] = nodes.step(c);
    return keep;
}

VisibilityNodes keep_nodes(const Device& device, const ShField& field, const Density& density, const Density* shares,
                           const VisibilitySettings& settings, Progress& progress) {
    const auto [nx, ny, nz] = field.grid.count;
    const auto functions = kernel::visibility_functions_for(device.isa);
    VisibilityNodes nodes = make_nodes(field.grid, field.coefficients, settings, shares != nullptr);
    VoxelBuffer opacity(nodes.surfaces.size() ? field.grid.size() * sizeof(float) : 0);
    float* alpha = opacity.size() ? reinterpret_cast<float*>(opacity.data()) : nullptr;
    const auto rows = [&, nx = nx](std::int64_t first, std::int64_t end) {
        for (auto r = first; r < end; ++r) functions.opacity({density.data(), alpha}, r * nx, nx);
    };
    if (alpha) parallel_for(device.threads, std::int64_t(ny) * nz, 16, rows);
    const kernel::KeepKernel keep = keep_kernel(nodes, field.node(0), alpha, shares ? shares->data() : nullptr);
    parallel_for(device.threads, std::int64_t(ny) * nz, 8, "keep", progress,
                 [&, ny = ny](std::int64_t first, std::int64_t end) {
                     for (auto r = first; r < end; ++r) functions.keep_row(keep, {int(r % ny), int(r / ny)});
                 });
    progress.check();
    return nodes;
}

}  // namespace chiaro
