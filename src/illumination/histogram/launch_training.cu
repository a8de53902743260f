// Training a codebook on cards: the same source, one thread a histogram; sums of whole numbers, in any order.
#include "cuda/launch.h"
#include "illumination/histogram/launch_card.h"

namespace chiaro::kernel {
namespace {

struct AssignVector {
    CodebookView book;
    WordedVectors vectors;
    CHIARO_ON_CARD void operator()(std::int64_t i) const {
        assign_each(book, vectors.histograms + i * book.bins, 1, vectors.words + i, vectors.differences + i);
    }
};
struct AddUpVector {
    WordedVectors vectors;
    cuda::Count* sums;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        const std::int64_t i = item / vectors.bins;
        atomicAdd(sums + std::int64_t(vectors.words[i]) * vectors.bins + item % vectors.bins,
                  cuda::Count(vectors.histograms[item]));
    }
};

}  // namespace

template void run_on_card(cuda::Stream&, std::int64_t, const CountEdges&);
template void run_on_card(cuda::Stream&, std::int64_t, const CountChosen&);
template void run_on_card(cuda::Stream&, std::int64_t, const PlaceChosen&);
template void run_on_card(cuda::Stream&, std::int64_t, const PickVectors&);
template void run_on_card(cuda::Stream&, std::int64_t, const WordDifferences&);
template void run_on_card(cuda::Stream&, std::int64_t, const RankNeighbours&);

void assign_vectors(cuda::Stream& stream, const CodebookView& book, const WordedVectors& vectors) {
    cuda::launch_items(stream, vectors.count, AssignVector{book, vectors});
}
void add_up_vectors(cuda::Stream& stream, const WordedVectors& vectors, cuda::Count* sums) {
    cuda::launch_items(stream, std::int64_t(vectors.count) * vectors.bins, AddUpVector{vectors, sums});
}

}  // namespace chiaro::kernel
