// Cells on a GPU: where their numbers lie there, and blocks of them for many threads.
#pragma once
#include <chiaro/progress.h>

#include <cstring>

#include "cuda/device_cache.h"
#include "illumination/cells/block_place.h"
#include "illumination/cells/grid.h"

namespace chiaro {

inline constexpr std::size_t blocks_together = 256;  ///< 8 million threads, and room for their tiles

/// Blocks that are taken at a time, and how many times before the host waits: work that is cancelled ends after these.
struct Turns {
    std::size_t blocks = blocks_together;
    int in_flight = 8;

    Turns() = default;
    Turns(std::size_t blocks_of_long_work) : blocks(blocks_of_long_work), in_flight(1) {}
};

/// Numbers of cells that are made on a GPU: 0 at first.
class GpuCells {
public:
    GpuCells(const Device& device, const CellGrid& grid)
        : stream_(device.stream), values_(grid), made_(*stream_, values_.buffer.size()) {
        made_.zero();
    }
    std::uint16_t* data() const { return reinterpret_cast<std::uint16_t*>(made_.data()); }
    /// The GPU keeps them; they come when the host first reads what is returned.
    CellValues release() {
        values_.buffer.keep(stream_, made_.data());
        return std::move(values_);
    }

private:
    const std::shared_ptr<cuda::Stream> stream_;
    CellValues values_;
    cuda::Array<std::byte> made_;
};

/// The blocks of a map in order.
inline std::vector<kernel::BlockPlace> places_of(const BlockMap& map) {
    std::vector<kernel::BlockPlace> places;
    for (const std::size_t b : map.held()) {
        const auto [x, y, z] = map.at(b);
        places.push_back({{x * block_edge, y * block_edge, z * block_edge}, {}});
        std::memcpy(places.back().pieces, map.pieces_of(b).bits, sizeof places.back().pieces);
    }
    return places;
}

/// work(places, how many blocks they are) for all blocks of a map in order, so many at a time; reports and may be
/// cancelled when each is on its way. Waits at the end at the latest.
template <class Work>
void for_blocks(cuda::Stream& stream, const BlockMap& map, std::string_view stage, Progress& progress, const Work& work,
                const Turns& turns = {}) {
    const std::vector<kernel::BlockPlace> places = places_of(map);
    if (places.empty()) return;
    const cuda::SyncOnExit sync{stream};
    const cuda::Array<kernel::BlockPlace> there(stream, places.size());
    stream.upload(there.data(), places.data(), places.size() * sizeof places[0]);
    int in_flight = 0;
    for (std::size_t first = 0; first < places.size(); first += turns.blocks) {
        const std::size_t count = std::min(turns.blocks, places.size() - first);
        work(there.data() + first, std::int64_t(count));
        if (++in_flight % turns.in_flight == 0) stream.wait();
        progress.report(stage, double(first + count) / double(places.size()));
        progress.check();
    }
    stream.wait();
}

}  // namespace chiaro
