#include "illumination/histogram/card.h"

#include "illumination/histogram/card_left_over.h"

namespace chiaro {

void assign_on_card(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& book,
                    LocalHistograms& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto histograms = make_card_histograms(device, data, path, out.subsample);
    CardLeftOver left_over(stream, 2 * histograms->cells_together());
    cuda::Array<std::byte> words(stream, out.identifiers.size());
    words.zero();
    kernel::AssignSlab assign{.slab = {},
                              .book = book.view_on_card(stream),
                              .words = reinterpret_cast<std::uint16_t*>(words.data()),
                              .nodes = {out.nodes[0], out.nodes[1], out.nodes[2]}};
    histograms->find(BlockMap(data.cells.grid.count, true), "histograms", progress,
                     [&](const kernel::HistogramSlab& slab, std::int64_t blocks) {
                         assign.slab = slab;
                         kernel::assign_slab(stream, assign, left_over.none(), blocks);
                     });
    stream.download(out.identifiers.data(), words.data(), words.size());
    stream.wait();
    try {
        stream.mirror()->keep(HostArray::of(out.life, out.identifiers), words.data(), stream);
    } catch (const cuda::OutOfMemory&) {
    }  // they are here too, and are sent when they are needed
}

void lift_on_card(const Device& device, const BinnedCells& cells, kernel::LiftKernel lift, LocalHistograms& h) {
    cuda::Stream& stream = *device.stream;
    cuda::Array<std::byte> lifted(stream, h.lifted.size());
    lifted.zero();
    lift.cells = cells.view_on_card(stream);
    lift.words =
        reinterpret_cast<const std::uint16_t*>(stream.mirror()->of(HostArray::of(h.life, h.identifiers), stream));
    lift.lifted = reinterpret_cast<std::uint16_t*>(lifted.data());
    kernel::lift_nodes(stream, lift);
    h.lifted.keep(device.stream, lifted.data());
}

}  // namespace chiaro
