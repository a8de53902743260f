// Slabs of histograms, and identifiers, on GPUs: the same source.
#include "illumination/histogram/unresolved.h"

namespace chiaro::kernel {
namespace {

struct NormalOffsetNode {
    NormalOffsetKernel normal_offset;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        const std::int64_t row = item / normal_offset.nodes[0];
        normal_offset(int(item % normal_offset.nodes[0]), int(row % normal_offset.nodes[1]),
                      int(row / normal_offset.nodes[1]));
    }
};

struct FindNear {
    AssignSlab assign;
    Unresolved left;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        assign.find_near(item, [&](std::int64_t i) { leave_unresolved(left, i); });
    }
};
struct TryAll {
    AssignSlab assign;
    Unresolved left;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        if (item < std::int64_t(*left.count)) assign.try_all(left.which[item]);
    }
};

}  // namespace

void assign_slab(cuda::Stream& stream, const AssignSlab& assign, const Unresolved& left, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * HistogramSlab::plane * 2, FindNear{assign, left});
    cuda::launch_items(stream, blocks * assign.slab.cells() * 2, TryAll{assign, left});
}

template void run_on_gpu(cuda::Stream&, std::int64_t, const TakeFromSlab&);

void normal_offset_nodes(cuda::Stream& stream, const NormalOffsetKernel& normal_offset) {
    cuda::launch_items(stream, std::int64_t(normal_offset.nodes[0]) * normal_offset.nodes[1] * normal_offset.nodes[2],
                       NormalOffsetNode{normal_offset});
}

}  // namespace chiaro::kernel
