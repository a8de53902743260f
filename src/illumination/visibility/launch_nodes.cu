// Nodes on GPUs: the same source, one thread a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro::kernel {
namespace {

struct KeepNode {
    KeepKernel kernel;
    CHIARO_DEVICE void operator()(std::int64_t node) const { kernel(node, 1); }
};

struct LightNode {
    LightKernel kernel;
    CHIARO_DEVICE void operator()(std::int64_t node) const { kernel(node, 1); }
};

}  // namespace

void keep_all_nodes(cuda::Stream& stream, const KeepKernel& kernel, std::int64_t nodes) {
    cuda::launch_items(stream, nodes, KeepNode{kernel});
}
void light_all_nodes(cuda::Stream& stream, const LightKernel& kernel, std::int64_t nodes) {
    cuda::launch_items(stream, nodes, LightNode{kernel});
}

}  // namespace chiaro::kernel
