// The table of words on GPUs: the same source, a thread for each part of a word's sums.
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

}  // namespace chiaro::kernel
