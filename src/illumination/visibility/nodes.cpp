#include "illumination/visibility/nodes.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/sh/basis.h"
#include "illumination/visibility/launch.h"

namespace chiaro {

namespace {

float step_of_bytes(int coefficient) {
    return float(coefficient_bounds[std::size_t(coefficient)] / (coefficient == 0 ? 255 : 127));
}

}  // namespace

float VisibilityNodes::step(int coefficient) const { return storage == ShStorage::u8 ? step_of_bytes(coefficient) : 1; }

VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings) {
    const std::size_t bytes_per_node = std::size_t(coefficients) << int(settings.storage);
    return {grid, settings.storage, settings.window, coefficients, VoxelBuffer(grid.size() * bytes_per_node), {}};
}

kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field) {
    kernel::KeepKernel keep{
        field, nullptr, nodes.harmonics.data(), kernel::Stored(nodes.storage), nodes.coefficients, {}, {}, {}, {}, {}};
    for (int i = 0; i < kernel::KeepKernel::width; ++i) {
        const int c = i % nodes.coefficients;
        keep.steps[i] = nodes.step(c);
        keep.least[i] = c == 0 ? 0 : -127, keep.most[i] = c == 0 ? 255 : 127;
        keep.per_sum[i] = 1.0f / float(kernel::AddSteps::per_byte(c));
        keep.middle[i] = c == 0 ? float(kernel::StoredHarmonics::middle) : 0;
    }
    return keep;
}

kernel::AddSteps add_steps_kernel(int coefficients) {
    kernel::AddSteps add{{}, coefficients};
    for (int c = 0; c < coefficients; ++c) add.per_unit[c] = float(kernel::AddSteps::per_byte(c)) / step_of_bytes(c);
    return add;
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

VisibilityNodes keep_nodes(const Device& device, ShSteps steps, const VisibilitySettings& settings,
                           Progress& progress) {
    constexpr std::int64_t together = std::int64_t(1) << 16;  // nodes: 2 MiB of sums, a large page
    VisibilityNodes nodes = make_nodes(steps.grid, steps.coefficients, settings);
    kernel::KeepKernel keep = keep_kernel(nodes, nullptr);
    keep.sums = steps.node(0);
    const auto run = kernel::visibility_functions_for(device.isa).keep;
    const auto all = std::int64_t(steps.grid.size());
    for (std::int64_t at = 0; at < all; at += together) {
        const std::int64_t count = std::min(together, all - at);
        parallel_for(device.threads, count, 4096,
                     [&](std::int64_t first, std::int64_t end) { run(keep, at + first, std::int32_t(end - first)); });
        steps.buffer.discard_before(std::size_t((at + count) * steps.coefficients) * sizeof(std::uint16_t));
        progress.report("keep", double(at + count) / double(all));
        progress.check();
    }
    return nodes;
}

}  // namespace chiaro
