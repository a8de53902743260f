// Slabs of histograms, and identifiers, on cards: the same source.
#include "illumination/histogram/left_over.h"

namespace chiaro::kernel {
namespace {

struct LiftNode {
    LiftKernel lift;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        const std::int64_t row = item / lift.nodes[0];
        lift(int(item % lift.nodes[0]), int(row % lift.nodes[1]), int(row / lift.nodes[1]));
    }
};

struct FindNear {
    AssignSlab assign;
    LeftOver left;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        assign.find_near(item, [&](std::int64_t i) { leave_over(left, i); });
    }
};
struct TryAll {
    AssignSlab assign;
    LeftOver left;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        if (item < std::int64_t(*left.count)) assign.try_all(left.which[item]);
    }
};

}  // namespace

void assign_slab(cuda::Stream& stream, const AssignSlab& assign, const LeftOver& left, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * HistogramSlab::plane * 2, FindNear{assign, left});
    cuda::launch_items(stream, blocks * assign.slab.cells() * 2, TryAll{assign, left});
}

template void run_on_card(cuda::Stream&, std::int64_t, const TakeFromSlab&);

void lift_nodes(cuda::Stream& stream, const LiftKernel& lift) {
    cuda::launch_items(stream, std::int64_t(lift.nodes[0]) * lift.nodes[1] * lift.nodes[2], LiftNode{lift});
}

}  // namespace chiaro::kernel
