// Lifting off surfaces on cards: the same source, one thread a cell.
#include "cuda/launch.h"
#include "illumination/cells/launch_card.h"

namespace chiaro::kernel {
namespace {

struct LoadLift {
    LiftBatch batch;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { batch.load(item); }
};
struct ScaleLift {
    LiftBatch batch;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { batch.scale(item); }
};
struct AnswerLift {
    LiftBatch batch;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { batch.answer(item); }
};

}  // namespace

void lift_blocks(cuda::Stream& stream, const LiftBatch& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * LiftTile::size, LoadLift{batch});
    cuda::launch_items(stream, blocks * LiftTile::size, ScaleLift{batch});
    cuda::launch_items(stream, blocks * BlockPlace::cells, AnswerLift{batch});
}

}  // namespace chiaro::kernel
