// Empty-space skipping (Krüger and Westermann 2003): cells whose range of values the transfer function leaves empty,
// and around each cell the largest cube of cells that are all like it.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "classify/medium.h"
#include "core/threads.h"

namespace chiaro {
namespace {

/// x fastest.
template <class T>
struct CellGrid {
    std::array<int, 3> count;
    std::vector<T> at;
    std::size_t row(int y, int z) const { return (std::size_t(z) * count[1] + y) * count[0]; }
};

using Test = std::function<bool(float, float)>;

CellGrid<std::uint8_t> occupied_cells(const CellRanges& ranges, const Test& is_visible, int threads,
                                      const Progress& progress) {
    CellGrid<std::uint8_t> cells{ranges.count, std::vector<std::uint8_t>(ranges.low.size())};
    parallel_for(threads, std::int64_t(ranges.low.size()), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
        if (progress.cancelled()) return;
        for (auto c = begin; c < end; ++c) cells.at[c] = is_visible(ranges.low[c], ranges.high[c]);
    });
    progress.check();
    return cells;
}

/// Distances to the nearest cell of the other kind: a neighbour of the same kind offers its own distance and one more,
/// one of the other kind offers 1.
template <class Kind>
class KindDistance {
public:
    KindDistance(const CellGrid<Kind>& kind, const Progress& progress)
        : kind_(kind),
          progress_(progress),
          distance_{kind.count, std::vector<std::uint8_t>(kind.at.size(), kernel::farthest)} {}

    /// Chebyshev distances in two sweeps over 13 neighbours each (Borgefors 1986), exact for this metric. What lies
    /// beyond the volume counts for nothing.
    const CellGrid<std::uint8_t>& compute() {
        sweep(1);
        sweep(-1);
        return distance_;
    }

private:
    void sweep(int sign) {
        const auto [nx, ny, nz] = kind_.count;
        for (int k = 0; k < nz; ++k) {
            progress_.check();
            for (int j = 0; j < ny; ++j) {
                const int z = sign > 0 ? k : nz - 1 - k, y = sign > 0 ? j : ny - 1 - j;
                const int before = z - sign, above = y - sign;
                const std::size_t row = kind_.row(y, z);
                if (before >= 0 && before < nz)
                    for (int other = std::max(y - 1, 0); other <= std::min(y + 1, ny - 1); ++other)
                        relax_row(kind_.row(other, before), row, nx);
                if (above >= 0 && above < ny) relax_row(kind_.row(above, z), row, nx);
                const int first = sign > 0 ? 1 : nx - 2;
                for (int x = first; x >= 0 && x < nx; x += sign) relax(row + x - sign, row + x);
            }
        }
    }

    /// From the neighbours at x - 1, x and x + 1 in a row that the sweep has already passed.
    void relax_row(std::size_t neighbours, std::size_t row, int nx) {
        for (int shift : {0, -1, 1}) {
            const int first = std::max(0, -shift), last = std::min(nx, nx - shift);
            // Plain pointers: the compiler turns this loop into vector instructions.
            const Kind *kind = &kind_.at[row], *their_kind = &kind_.at[neighbours] + shift;
            const std::uint8_t* theirs = &distance_.at[neighbours] + shift;
            std::uint8_t* distance = &distance_.at[row];
            for (int x = first; x < last; ++x) distance[x] = nearer(distance[x], kind[x] == their_kind[x], theirs[x]);
        }
    }

    void relax(std::size_t neighbour, std::size_t cell) {
        auto& distance = distance_.at[cell];
        distance = nearer(distance, kind_.at[neighbour] == kind_.at[cell], distance_.at[neighbour]);
    }

    static std::uint8_t nearer(std::uint8_t distance, bool same_kind, std::uint8_t neighbour) {
        const std::uint8_t offer = (same_kind ? neighbour : 0) + 1;
        return std::min(distance, offer);
    }

    const CellGrid<Kind>& kind_;
    const Progress& progress_;
    CellGrid<std::uint8_t> distance_;
};

template <class Kind, class IsOccupied>
std::vector<std::uint8_t> codes_of(const CellGrid<Kind>& kinds, const IsOccupied& is_occupied,
                                   const Progress& progress) {
    KindDistance<Kind> distances(kinds, progress);
    const CellGrid<std::uint8_t>& distance = distances.compute();
    std::vector<std::uint8_t> codes(kinds.at.size() + kernel::spare_bytes);
    for (std::size_t c = 0; c < kinds.at.size(); ++c)
        codes[c] = kernel::cell_code(distance.at[c], is_occupied(kinds.at[c]));
    return codes;
}

}  // namespace

RangeTest visible_range(const OpticalTable& table) {
    RangeTest test;
    test.before.assign(table.entries.size() + 1, 0);
    for (std::size_t j = 0; j < table.entries.size(); ++j)
        test.before[j + 1] = test.before[j] + (table.entries[j].extinction_per_mm > 0);
    test.view.before = test.before.data();
    test.view.index_scale = table.index_scale, test.view.index_offset = table.index_offset;
    test.view.last = double(table.entries.size()) - 1;
    return test;
}

RangeTest crossed_range(const DeviceVolume::Data& volume, const std::vector<IsoSurface>& surfaces) {
    static_assert(max_isosurfaces <= kernel::RangeView::max_surfaces);
    RangeTest test;
    for (const IsoSurface& surface : surfaces)
        test.view.surfaces[test.view.surface_count++] = (surface.value - volume.offset) / volume.scale;
    return test;
}

std::vector<std::uint8_t> make_occupancy(const CellRanges& ranges, const Test& is_visible, int threads,
                                         const Progress& progress, const std::vector<std::uint8_t>& left) {
    CellGrid<std::uint8_t> occupied = occupied_cells(ranges, is_visible, threads, progress);
    for (std::size_t c = 0; c < left.size(); ++c) occupied.at[c] &= left[c];
    return codes_of(
        occupied, [](std::uint8_t kind) { return kind != 0; }, progress);
}

std::vector<std::uint8_t> make_occupancy(const std::array<int, 3>& count, std::vector<std::uint32_t> kinds,
                                         std::uint32_t empty, const Progress& progress) {
    const CellGrid<std::uint32_t> cells{count, std::move(kinds)};
    return codes_of(
        cells, [empty](std::uint32_t kind) { return kind != empty; }, progress);
}

}  // namespace chiaro
