// Words from their members on GPUs: the same source, a thread a ball, then a bin of a word.
#include "cuda/launch.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro::kernel {

void count_members(cuda::Stream& stream, const CountMembers& count, std::int64_t members) {
    cuda::launch_items(stream, members, count);
}
void add_up_members(cuda::Stream& stream, const AddUpMembers& add_up, std::int64_t codewords) {
    cuda::launch_items(stream, codewords * add_up.bins, add_up);
}

}  // namespace chiaro::kernel
