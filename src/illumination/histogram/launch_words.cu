// The table of words on cards: the same source, a thread for each part of a word's sums.
#include "cuda/launch.h"
#include "illumination/histogram/launch_card.h"

namespace chiaro::kernel {
namespace {

struct FindPart {
    WordTable table;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { table.find_part(item); }
};
struct FoldParts {
    WordTable table;
    CHIARO_ON_CARD void operator()(std::int64_t item) const { table.fold_parts(item); }
};

}  // namespace

void find_word_sums(cuda::Stream& stream, const WordTable& table) {
    cuda::launch_items(stream, std::int64_t(table.words) * word_parts, FindPart{table});
    cuda::launch_items(stream, std::int64_t(table.words) * 4, FoldParts{table});
}

}  // namespace chiaro::kernel
