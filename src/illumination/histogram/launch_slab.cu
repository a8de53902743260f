// Slabs of histograms, and identifiers, on cards: the same source.
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

template void run_on_card(cuda::Stream&, std::int64_t, const AssignSlab&);
template void run_on_card(cuda::Stream&, std::int64_t, const TakeFromSlab&);

void lift_nodes(cuda::Stream& stream, const LiftKernel& lift) {
    cuda::launch_items(stream, std::int64_t(lift.nodes[0]) * lift.nodes[1] * lift.nodes[2], LiftNode{lift});
}

}  // namespace chiaro::kernel
