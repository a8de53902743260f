// Training a codebook on cards: the same source, one thread a histogram; sums of whole numbers, in any order.
#include "illumination/histogram/left_over.h"

namespace chiaro::kernel {
namespace {

struct AssignVector {
    CodebookView book;
    WordedVectors vectors;
    LeftOver left;
    CHIARO_ON_CARD void operator()(std::int64_t i) const {
        store(i, near_word(book, vectors.histograms + i * book.bins, vectors.words[i]));
    }
    CHIARO_ON_CARD void store(std::int64_t i, const FoundWord& found) const {
        vectors.words[i] = std::uint16_t(found.word), vectors.differences[i] = found.difference;
        if (!found.is_nearest) leave_over(left, i);
    }
};
struct TryAllVector : AssignVector {
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        if (item >= std::int64_t(*left.count)) return;
        const std::int64_t i = left.which[item];
        store(i,
              word_of_all(book, vectors.histograms + i * book.bins, {vectors.words[i], vectors.differences[i], false}));
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

void assign_vectors(cuda::Stream& stream, const CodebookView& book, const WordedVectors& vectors,
                    const LeftOver& left) {
    cuda::launch_items(stream, vectors.count, AssignVector{book, vectors, left});
    cuda::launch_items(stream, vectors.count, TryAllVector{{book, vectors, left}});
}
void add_up_vectors(cuda::Stream& stream, const WordedVectors& vectors, cuda::Count* sums) {
    cuda::launch_items(stream, std::int64_t(vectors.count) * vectors.bins, AddUpVector{vectors, sums});
}

}  // namespace chiaro::kernel
