// Slabs of histograms, and identifiers, on GPUs: the same source, a thread a ball, a row or a node.
#include "cuda/each_node.h"
#include "illumination/histogram/slab_source.h"
#include "illumination/histogram/unresolved.h"

namespace chiaro::kernel {
namespace {

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

template void run_on_gpu(cuda::Stream&, std::int64_t, const PlaceCells&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const CountSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const PackSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const SweepSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const TakeFromSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<NormalOffsetKernel>&);

}  // namespace chiaro::kernel
