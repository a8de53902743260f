// Planes of histograms, and identifiers, on cards: the same source, one thread a cell or half of it.
#include "cuda/launch.h"
#include "illumination/histogram/launch_card.h"

namespace chiaro::kernel {
namespace {

struct LiftNode {
    LiftKernel lift;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        const std::int64_t row = item / lift.nodes[0];
        lift(int(item % lift.nodes[0]), int(row % lift.nodes[1]), int(row / lift.nodes[1]));
    }
};

}  // namespace

void assign_plane(cuda::Stream& stream, const AssignPlane& assign, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * HistogramPlane::cells * 2, assign);
}
void take_from_plane(cuda::Stream& stream, const TakeFromPlane& take, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * HistogramPlane::cells, take);
}
void lift_nodes(cuda::Stream& stream, const LiftKernel& lift) {
    cuda::launch_items(stream, std::int64_t(lift.nodes[0]) * lift.nodes[1] * lift.nodes[2], LiftNode{lift});
}

}  // namespace chiaro::kernel
