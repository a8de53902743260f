// Coarser grids and stored levels on cards: the same source, one thread a cell.
#include "cuda/launch.h"
#include "illumination/spao/launch_card.h"

namespace chiaro::kernel {
namespace {

template <class Source>
struct FillCell {
    Source source;
    GridTarget target;

    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        const std::int64_t row = item / target.count[0];
        const std::int32_t x = std::int32_t(item % target.count[0]), y = std::int32_t(row % target.count[1]),
                           z = std::int32_t(row / target.count[1]);
        target.to[std::int64_t(z) * target.slice + std::int64_t(y) * target.row + x] = source.at(x, y, z);
    }
};

struct AnswerStored {
    StoredBatch batch;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { batch.answer(item); }
};

}  // namespace

template <class Source>
void fill_grid(cuda::Stream& stream, const Source& source, const GridTarget& target) {
    cuda::launch_items(stream, std::int64_t(target.count[0]) * target.count[1] * target.count[2],
                       FillCell<Source>{source, target});
}
template void fill_grid(cuda::Stream&, const OpacityGrid&, const GridTarget&);
template void fill_grid(cuda::Stream&, const EveryOther&, const GridTarget&);
template void fill_grid(cuda::Stream&, const MeanOfEight&, const GridTarget&);
template void fill_grid(cuda::Stream&, const CrossingOfEight&, const GridTarget&);
template void fill_grid(cuda::Stream&, const CornerWeights&, const GridTarget&);
template void fill_grid(cuda::Stream&, const NextNBuffer&, const GridTarget&);

void answer_stored(cuda::Stream& stream, const StoredBatch& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * BlockPlace::cells, AnswerStored{batch});
}

}  // namespace chiaro::kernel
