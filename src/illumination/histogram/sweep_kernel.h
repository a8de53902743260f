// Histograms of whole balls along a row of cells, each from the one before, in whole numbers.
#pragma once
#include "illumination/histogram/ball_view.h"
#include "illumination/histogram/bin_grid.h"
#include "illumination/histogram/packing_view.h"

namespace chiaro::kernel {

struct SweptRow {
    BallView ball;
    BinGrid cells;
    PackingView packing;
    std::int32_t bins;  ///< of a vector
    double scale;       ///< packed_one for a full ball

    /// Of every `step`th cell of [first, end) in a row, `apart` numbers from one to the next: the same twice, there
    /// being but one half. `counts`: room for a vector.
    CHIARO_INLINE void find(int first, int end, int y, int z, int step, std::int32_t* counts, std::int16_t* histograms,
                            std::int64_t apart) const {
        for (int k = 0; k < bins; ++k) counts[k] = 0;
        for_rows([&](const BallRow& row) CHIARO_INLINE_LAMBDA {
            for (int dx = -row.reach; dx <= row.reach; ++dx) add<1>(first + dx, y + row.dy, z + row.dz, counts);
        });
        for (int x = first; x < end; ++x) {
            if ((x - first) % step == 0) {
                add<-1>(x, y, z, counts);
                for (int k = 0; k < bins; ++k)
                    histograms[k] = histograms[bins + k] = std::int16_t(counts[k] * scale + 0.5);
                add<1>(x, y, z, counts);
                histograms += apart;
            }
            for_rows([&](const BallRow& row) CHIARO_INLINE_LAMBDA {
                add<-1>(x - row.reach, y + row.dy, z + row.dz, counts);
                add<1>(x + 1 + row.reach, y + row.dy, z + row.dz, counts);
            });
        }
    }

private:
    template <class Use>
    CHIARO_INLINE void for_rows(Use&& use) const {
        for (std::int32_t i = 0; i < ball.rows; ++i) use(ball.row[i]);
    }
    template <int sign>
    CHIARO_INLINE void add(int x, int y, int z, std::int32_t* counts) const {
        if (cells.holds(x, y, z)) packing.add<sign>(*cells.cell(x, y, z), counts);
    }
};

}  // namespace chiaro::kernel
