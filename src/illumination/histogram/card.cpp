#include "illumination/histogram/card.h"

#include "illumination/cells/card.h"

namespace chiaro {
namespace {

using kernel::HistogramPlane;

constexpr std::size_t most_room = std::size_t(1) << 30;

const std::uint16_t* bins_on_card(cuda::Stream& stream, const BinnedCells& cells) {
    return reinterpret_cast<const std::uint16_t*>(stream.mirror()->of(HostArray::of(cells.life, cells.buffer), stream));
}

/// Of all rows and cells of a plane, so that rooms follow each other.
std::size_t room_of(kernel::FastBlock& block, std::byte* memory) {
    return (give_room(block, block_edge, block_edge, memory) + 255) / 256 * 256;
}

std::size_t room_bytes_of(kernel::FastBlock block) { return room_of(block, nullptr); }

/// As many blocks as there is room for, and no two above each other.
std::size_t together_of(std::size_t room_bytes, const CellGrid& grid) {
    const BlockMap blocks(grid.count);
    return std::clamp<std::size_t>(most_room / room_bytes, 1, std::size_t(blocks.count[0]) * blocks.count[1]);
}

}  // namespace

CardHistograms::CardHistograms(const Device& device, const HistogramData& data, int step)
    : stream_(*device.stream),
      shape_(data.packing, data.radius),
      room_bytes_(room_bytes_of(shape_.block)),
      together_(together_of(room_bytes_, data.cells.grid)),
      code_(stream_, shape_.code.size()),
      blocks_(stream_, together_),
      room_(stream_, together_ * room_bytes_),
      normals_(stream_, together_ * 3 * HistogramPlane::cells),
      histograms_(stream_, together_ * 2 * HistogramPlane::cells * std::size_t(bins())) {
    std::vector<kernel::FastBlock> blocks(together_, shape_.block);
    for (std::size_t i = 0; i < together_; ++i) room_of(blocks[i], room_.data() + i * room_bytes_);
    const cuda::Settled settled{stream_};
    stream_.upload(blocks_.data(), blocks.data(), together_ * sizeof blocks[0]);
    stream_.upload(code_.data(), shape_.code.data(), code_.size() * sizeof shape_.code[0]);
    batch_.blocks = blocks_.data(), batch_.code = code_.data();
    batch_.normals = normals_.data(), batch_.histograms = histograms_.data();
    batch_.bins = bins(), batch_.tile_size = shape_.block.tile_size(), batch_.step = step;
    batch_.grid = data.cells.view();
    batch_.grid.bins = bins_on_card(stream_, data.cells);
}

void CardHistograms::find(const BlockMap& map, std::string_view stage, Progress& progress, const UsePlane& use) {
    std::int32_t first = 0;
    const auto work = [&](const kernel::BlockPlace* places, std::int64_t blocks) {
        batch_.places = places;
        room_.zero();
        kernel::fast_sums(stream_, batch_, shape_.block, blocks);
        for (batch_.z = 0; batch_.z < block_edge; ++batch_.z) {
            kernel::fast_cells(stream_, batch_, blocks);
            use({places, first, batch_.z, batch_.bins, batch_.histograms}, blocks);
        }
        first += std::int32_t(blocks);
    };
    for_blocks(stream_, map, stage, progress, work, together_);
}

void assign_on_card(const Device& device, const HistogramData& data, const Codebook& book, LocalHistograms& out,
                    Progress& progress) {
    cuda::Stream& stream = *device.stream;
    CardHistograms histograms(device, data, out.subsample);
    HostArrays arrays;
    book.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    cuda::Array<std::byte> words(stream, out.identifiers.size());
    words.zero();
    const auto& cells = data.cells.grid.count;
    kernel::AssignPlane assign{.plane = {},
                               .book = book.view(),
                               .words = reinterpret_cast<std::uint16_t*>(words.data()),
                               .cells = {cells[0], cells[1], cells[2]},
                               .nodes = {out.nodes[0], out.nodes[1], out.nodes[2]},
                               .step = out.subsample};
    views.swap(assign.book.words, assign.book.neighbours, assign.book.distances);
    histograms.find(BlockMap(cells, true), "histograms", progress,
                    [&](const HistogramPlane& plane, std::int64_t blocks) {
                        assign.plane = plane;
                        kernel::assign_plane(stream, assign, blocks);
                    });
    stream.download(out.identifiers.data(), words.data(), words.size());
    stream.wait();
    stream.mirror()->keep(HostArray::of(out.life, out.identifiers), words.data(), stream);
}

void lift_on_card(const Device& device, const BinnedCells& cells, kernel::LiftKernel lift, LocalHistograms& h) {
    cuda::Stream& stream = *device.stream;
    cuda::Array<std::byte> lifted(stream, h.lifted.size());
    lifted.zero();
    lift.cells.bins = bins_on_card(stream, cells);
    lift.words =
        reinterpret_cast<const std::uint16_t*>(stream.mirror()->of(HostArray::of(h.life, h.identifiers), stream));
    lift.lifted = reinterpret_cast<std::uint16_t*>(lifted.data());
    kernel::lift_nodes(stream, lift);
    h.lifted.keep(device.stream, lifted.data());
}

std::vector<PackedHistogram> sample_on_card(const Device& device, const HistogramData& data, const BlockMap& blocks,
                                            const std::vector<std::int32_t>& place, std::size_t cells,
                                            Progress& progress) {
    cuda::Stream& stream = *device.stream;
    CardHistograms histograms(device, data, 1);
    std::vector<PackedHistogram> found(2 * cells * std::size_t(histograms.bins()));
    const cuda::Settled settled{stream};
    const cuda::Array<std::int32_t> places(stream, place.size());
    const cuda::Array<PackedHistogram> list(stream, found.size());
    stream.upload(places.data(), place.data(), place.size() * sizeof place[0]);
    histograms.find(blocks, "histogram samples", progress, [&](const HistogramPlane& plane, std::int64_t count) {
        kernel::take_from_plane(stream, {plane, places.data(), list.data()}, count);
    });
    stream.download(found.data(), list.data(), found.size() * sizeof found[0]);
    stream.wait();
    return found;
}

}  // namespace chiaro
