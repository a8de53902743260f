// Nodes on GPUs: the same source, one thread a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro::kernel {
namespace {

struct OpacityOfNode {
    OpacityKernel kernel;
    CHIARO_DEVICE void operator()(std::int64_t node) const { kernel(node, 1); }
};

struct KeepNode {
    KeepKernel kernel;
    CHIARO_DEVICE void operator()(std::int64_t node) const {
        const std::int64_t row = node / kernel.count[0];
        kernel.keep_node(std::int32_t(node % kernel.count[0]), std::int32_t(row % kernel.count[1]),
                         std::int32_t(row / kernel.count[1]));
    }
};

struct LightNode {
    LightKernel kernel;
    CHIARO_DEVICE void operator()(std::int64_t node) const { kernel(node, 1); }
};

}  // namespace

void find_opacities(cuda::Stream& stream, const OpacityKernel& kernel, std::int64_t nodes) {
    cuda::launch_items(stream, nodes, OpacityOfNode{kernel});
}
void keep_all_nodes(cuda::Stream& stream, const KeepKernel& kernel) {
    cuda::launch_items(stream, std::int64_t(kernel.count[0]) * kernel.count[1] * kernel.count[2], KeepNode{kernel});
}
void light_all_nodes(cuda::Stream& stream, const LightKernel& kernel, std::int64_t nodes) {
    cuda::launch_items(stream, nodes, LightNode{kernel});
}

}  // namespace chiaro::kernel
