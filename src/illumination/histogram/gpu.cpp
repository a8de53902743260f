#include "illumination/histogram/gpu.h"

#include "illumination/histogram/gpu_unresolved.h"

namespace chiaro {

void assign_on_gpu(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& codebook,
                   LocalHistograms& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto histograms = make_gpu_histograms(device, data, path, out.subsample);
    GpuUnresolved unresolved(stream, 2 * histograms->cells_together());
    cuda::Array<std::byte> codewords(stream, out.identifiers.size());
    codewords.zero();
    kernel::AssignSlab assign{.slab = {},
                              .codebook = codebook.view_on_gpu(stream),
                              .codewords = reinterpret_cast<std::uint16_t*>(codewords.data()),
                              .nodes = {out.nodes[0], out.nodes[1], out.nodes[2]}};
    histograms->find(BlockMap(data.cells.grid.count, true), "histograms", progress,
                     [&](const kernel::HistogramSlab& slab, std::int64_t blocks) {
                         assign.slab = slab;
                         kernel::assign_slab(stream, assign, unresolved.none(), blocks);
                     });
    stream.download(out.identifiers.data(), codewords.data(), codewords.size());
    stream.wait();
    try {
        stream.device_cache()->keep(HostArray::of(out.life, out.identifiers), codewords.data(), stream);
    } catch (const cuda::OutOfMemory&) {
    }  // they are here too, and are sent when they are needed
}

void normal_offset_on_gpu(const Device& device, const BinnedCells& cells, kernel::NormalOffsetKernel normal_offset,
                          LocalHistograms& h) {
    cuda::Stream& stream = *device.stream;
    cuda::Array<std::byte> displaced(stream, h.displaced.size());
    displaced.zero();
    normal_offset.cells = cells.view_on_gpu(stream);
    normal_offset.codewords =
        reinterpret_cast<const std::uint16_t*>(stream.device_cache()->of(HostArray::of(h.life, h.identifiers), stream));
    normal_offset.displaced = reinterpret_cast<std::uint16_t*>(displaced.data());
    kernel::normal_offset_nodes(stream, normal_offset);
    h.displaced.keep(device.stream, displaced.data());
}

}  // namespace chiaro
