// The fused sweep on GPUs: the same source, one thread a cell or corner.
#include "cuda/launch.h"
#include "illumination/spao/launch_gpu.h"

namespace chiaro::kernel {
namespace {

struct LoadTiles {
    SpaoBatch batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.load(item); }
};

struct FindMeans {
    SpaoBatch batch;
    std::int32_t level;
    bool from_means;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.find_mean(item, level, from_means); }
};

template <bool at_cells>
struct Result {
    SpaoBatch batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.result<at_cells>(item); }
};

}  // namespace

void result_cells(cuda::Stream& stream, const SpaoBatch& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * SpaoTile::size, LoadTiles{batch});
    cuda::launch_items(stream, blocks * SpaoTile::size, FindMeans{batch, 1, false});
    cuda::launch_items(stream, blocks * SpaoTile::size, FindMeans{batch, 2, true});
    cuda::launch_items(stream, blocks * BlockPlace::cells, Result<true>{batch});
}
void result_corners(cuda::Stream& stream, const SpaoBatch& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * SpaoTile::size, LoadTiles{batch});
    cuda::launch_items(stream, blocks * SpaoTile::size, FindMeans{batch, 2, false});
    cuda::launch_items(stream, blocks * BlockPlace::cells, Result<false>{batch});
}

}  // namespace chiaro::kernel
