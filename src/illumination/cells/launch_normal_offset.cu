// Lifting off surfaces on GPUs: the same source, one thread a cell.
#include "cuda/launch.h"
#include "illumination/cells/launch_gpu.h"

namespace chiaro::kernel {
namespace {

struct LoadNormalOffset {
    NormalOffsetBatch batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.load(item); }
};
struct ScaleNormalOffset {
    NormalOffsetBatch batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.scale(item); }
};
struct ResultNormalOffset {
    NormalOffsetBatch batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.result(item); }
};

}  // namespace

void normal_offset_blocks(cuda::Stream& stream, const NormalOffsetBatch& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * NormalOffsetTile::size, LoadNormalOffset{batch});
    cuda::launch_items(stream, blocks * NormalOffsetTile::size, ScaleNormalOffset{batch});
    cuda::launch_items(stream, blocks * BlockPlace::cells, ResultNormalOffset{batch});
}

}  // namespace chiaro::kernel
