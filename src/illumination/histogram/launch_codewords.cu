// Words from their members, a thread a ball, then a bin of a word; and the table of words, a thread for each part of a
// word's sums: on GPUs the same source.
#include "cuda/launch.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro::kernel {
namespace {

struct FindPart {
    CodewordTable table;
    CHIARO_DEVICE void operator()(std::int64_t item) const { table.find_part(item); }
};
struct FoldParts {
    CodewordTable table;
    CHIARO_DEVICE void operator()(std::int64_t item) const { table.fold_parts(item); }
};

}  // namespace

void find_codeword_sums(cuda::Stream& stream, const CodewordTable& table) {
    cuda::launch_items(stream, std::int64_t(table.codewords) * codeword_parts, FindPart{table});
    cuda::launch_items(stream, std::int64_t(table.codewords) * 4, FoldParts{table});
}

void count_members(cuda::Stream& stream, const CountMembers& count, std::int64_t members) {
    cuda::launch_items(stream, members, count);
}
void add_up_members(cuda::Stream& stream, const AddUpMembers& add_up, std::int64_t codewords) {
    cuda::launch_items(stream, codewords * add_up.bins, add_up);
}

}  // namespace chiaro::kernel
