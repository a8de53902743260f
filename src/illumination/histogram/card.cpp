#include "illumination/histogram/card.h"

namespace chiaro {

void assign_on_card(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& book,
                    LocalHistograms& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto histograms = make_card_histograms(device, data, path, out.subsample);
    HostArrays arrays;
    book.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    cuda::Array<std::byte> words(stream, out.identifiers.size());
    words.zero();
    kernel::AssignSlab assign{.slab = {},
                              .book = book.view(),
                              .words = reinterpret_cast<std::uint16_t*>(words.data()),
                              .nodes = {out.nodes[0], out.nodes[1], out.nodes[2]}};
    views.swap(assign.book.words, assign.book.neighbours, assign.book.distances);
    histograms->find(BlockMap(data.cells.grid.count, true), "histograms", progress,
                     [&](const kernel::HistogramSlab& slab, std::int64_t blocks) {
                         assign.slab = slab;
                         kernel::run_on_card(stream, blocks * kernel::HistogramSlab::plane * 2, assign);
                     });
    stream.download(out.identifiers.data(), words.data(), words.size());
    stream.wait();
    stream.mirror()->keep(HostArray::of(out.life, out.identifiers), words.data(), stream);
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

std::vector<PackedHistogram> sample_on_card(const Device& device, const HistogramData& data, HistogramPath path,
                                            const BlockMap& blocks, const std::vector<std::int32_t>& place,
                                            std::size_t cells, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto histograms = make_card_histograms(device, data, path, 1);
    std::vector<PackedHistogram> found(2 * cells * std::size_t(histograms->bins()));
    const cuda::Settled settled{stream};
    const cuda::Array<std::int32_t> places(stream, place.size());
    const cuda::Array<PackedHistogram> list(stream, found.size());
    stream.upload(places.data(), place.data(), place.size() * sizeof place[0]);
    const auto take = [&](const kernel::HistogramSlab& slab, std::int64_t count) {
        kernel::run_on_card(stream, count * slab.cells(), kernel::TakeFromSlab{slab, places.data(), list.data()});
    };
    histograms->find(blocks, "histogram samples", progress, take);
    stream.download(found.data(), list.data(), found.size() * sizeof found[0]);
    stream.wait();
    return found;
}

}  // namespace chiaro
