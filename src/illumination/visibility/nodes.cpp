#include "illumination/visibility/nodes.h"

#include "core/threads.h"
#include "illumination/sh/basis.h"
#include "illumination/visibility/launch.h"

namespace chiaro {

float VisibilityNodes::step(int coefficient) const {
    if (storage != ShStorage::u8) return 1;
    return float(coefficient_bounds[std::size_t(coefficient)] / (coefficient == 0 ? 255 : 127));
}

VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings) {
    const std::size_t bytes_per_node = std::size_t(coefficients) << int(settings.storage);
    return {grid, settings.storage, settings.window, coefficients, VoxelBuffer(grid.size() * bytes_per_node), {}};
}

kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field) {
    kernel::KeepKernel keep{
        field, nodes.harmonics.data(), kernel::Stored(nodes.storage), nodes.coefficients, {}, {}, {}, {}};
    for (int i = 0; i < kernel::KeepKernel::width; ++i) {
        const int c = i % nodes.coefficients;
        keep.steps[i] = nodes.step(c);
        keep.least[i] = c == 0 ? 0 : -127, keep.most[i] = c == 0 ? 255 : 127;
        keep.middle[i] = c == 0 ? float(kernel::StoredHarmonics::middle) : 0;
    }
    return keep;
}

VisibilityNodes keep_nodes(const Device& device, const ShField& field, const VisibilitySettings& settings,
                           Progress& progress) {
    VisibilityNodes nodes = make_nodes(field.grid, field.coefficients, settings);
    const kernel::KeepKernel keep = keep_kernel(nodes, field.node(0));
    const auto run = kernel::visibility_functions_for(device.isa).keep;
    parallel_for(device.threads, std::int64_t(field.grid.size()), 4096, "keep", progress,
                 [&](std::int64_t first, std::int64_t end) { run(keep, first, std::int32_t(end - first)); });
    progress.check();
    return nodes;
}

}  // namespace chiaro
