// Histograms of blocks of cells on GPUs: the same source, a thread for a column, a bin or a cell.
#include "cuda/launch.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro::kernel {
namespace {

template <class Step>
void launch(cuda::Stream& stream, const FastBatch& batch, std::int64_t blocks) {
    const Step step{batch};
    cuda::launch_items(stream, blocks * step.items(), step);
}

}  // namespace

void fast_sums(cuda::Stream& stream, FastBatch batch, const FastBlock& shape, std::int64_t blocks) {
    launch<LoadTile>(stream, batch, blocks);
    for_columns(shape, [&](const Columns& columns, int from, int end) {
        batch.columns = columns;
        launch<FillColumns>(stream, batch, blocks);
        for (int n = from; n < end; ++n) {
            batch.box = shape.box[n];
            launch<SumColumns>(stream, batch, blocks);
            launch<SumRows>(stream, batch, blocks);
        }
    });
}
void fast_cells(cuda::Stream& stream, const FastBatch& batch, std::int64_t blocks) {
    launch<InterpolatePlanes>(stream, batch, blocks);
    launch<InterpolateRows>(stream, batch, blocks);
    launch<CountNear>(stream, batch, blocks);
    launch<FinishCells>(stream, batch, blocks);
}

}  // namespace chiaro::kernel
