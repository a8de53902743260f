#include "illumination/visibility/gpu.h"

#include <utility>

#include "illumination/cells/gpu.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro {

void assemble_on_gpu(const Device& device, const BlockMap& blocks, int halvings, const BlockDepths& depths,
                     Density& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const std::size_t together = std::clamp<std::size_t>(blocks.held().size(), 1, blocks_together);
    const cuda::Array<float> tiles(stream, together * tile_size), halves(stream, halvings ? tiles.size() / 8 : 1);
    cuda::Array<float> made(stream, out.grid.size());
    made.zero();
    const FillBlocks fill = depths.on_gpu(stream);
    const auto [nx, ny, nz] = out.grid.count;
    for_blocks(stream, blocks, "density", progress, [&](const kernel::BlockPlace* places, std::int64_t count) {
        fill(places, count, tiles.data());
        float *from = tiles.data(), *to = halves.data();
        for (int i = 0; i < halvings; ++i, std::swap(from, to))
            kernel::run_on_gpu(stream, count * (tile_size >> 3 * (i + 1)),
                               kernel::HalveTiles{from, to, block_edge >> i});
        kernel::run_on_gpu(stream, count * (tile_size >> 3 * halvings),
                           kernel::KeepTiles{from, block_edge >> halvings, places, {nx, ny, nz}, made.data()});
    });
    out.buffer.keep(device.stream, made.data());
}

GpuField::GpuField(const Device& device, const Density& density, int coefficients, bool in_steps)
    : stream_(device.stream), grid_(density.grid), coefficients_(coefficients), density_(density.on_gpu(*stream_)) {
    if (in_steps)
        steps_.emplace(*stream_, size()).zero();
    else
        field_.emplace(*stream_, size()).zero();
}

void GpuField::fetch(ShField& field) const {
    stream_->download(field.buffer.data(), data(), size() * sizeof(float));
    stream_->wait();
}

void GpuField::add(const float* parts, std::int32_t count) const {
    const auto numbers = std::int64_t(size());
    if (is_in_steps())
        kernel::run_on_gpu(
            *stream_, numbers,
            kernel::AddStepParts{add_steps_kernel(coefficients_), steps_->data(), parts, numbers, count});
    else
        kernel::run_on_gpu(*stream_, numbers, kernel::AddParts{data(), parts, numbers, count});
}

VisibilityNodes GpuField::keep(const VisibilitySettings& settings) const {
    VisibilityNodes nodes = make_nodes(grid_, coefficients_, settings);
    const cuda::Array<std::byte> harmonics(*stream_, nodes.harmonics.size());
    kernel::KeepKernel keep = keep_kernel(nodes, is_in_steps() ? nullptr : data());
    if (is_in_steps()) keep.sums = steps_->data();
    keep.harmonics = harmonics.data();
    kernel::keep_all_nodes(*stream_, keep, std::int64_t(grid_.size()));
    stream_->download(nodes.harmonics.data(), harmonics.data(), nodes.harmonics.size());
    stream_->wait();
    return nodes;
}

void light_on_gpu(const Device& device, const kernel::LightKernel& kernel, const HostArrays& arrays,
                  std::size_t nodes) {
    cuda::Stream& stream = *device.stream;
    cuda::Views views(stream, arrays);
    const cuda::Array<kernel::Light16> light(stream, 4 * nodes);
    kernel::LightKernel on_gpu = kernel;
    views.to_device_pointers(on_gpu.harmonics.nodes);
    on_gpu.light = light.data();
    kernel::light_all_nodes(stream, on_gpu, std::int64_t(nodes));
    stream.download(kernel.light, light.data(), light.size() * sizeof(kernel::Light16));
    stream.wait();
}

}  // namespace chiaro
