// Where packed histograms come from, block by block: one class for each path.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include <functional>
#include <memory>

#include "illumination/histogram/cells.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/packing.h"

namespace chiaro {

class HistogramSource {
public:
    virtual ~HistogramSource() = default;
    int bins() const { return bins_; }

    using Wanted = std::function<bool(int y, int z)>;
    using UseRow = std::function<void(int y, int z, const PackedHistogram* histograms)>;
    /// Calls use_row for every `step`th row of a block (of a BlockMap over the grid) that is wanted, with the
    /// histograms of every `step`th of its cells: forward, backward. Any thread may ask.
    virtual void find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const = 0;

protected:
    HistogramSource(const BinnedCells& cells, int bins) : cells_(cells), bins_(bins) {}
    /// Calls row(x, y, z) for the rows that are wanted; x: first cell and end.
    template <class Row>
    void for_rows(std::size_t block, int step, const Wanted& wanted, Row&& row) const {
        const auto [x, y, z] = BlockMap(cells_.grid.count).cells(block, cells_.grid.count);
        for (int k = z.first; k < z.second; k += step)
            for (int j = y.first; j < y.second; j += step)
                if (wanted(j, k)) row(x, j, k);
    }

    const BinnedCells& cells_;
    const int bins_;
};

/// What all sources need; lives as long as they do.
struct HistogramData {
    BinnedCells cells;
    Packing packing;
    int radius;
};
std::unique_ptr<HistogramSource> make_source(const Device& device, const HistogramData& data, HistogramPath path);

}  // namespace chiaro
