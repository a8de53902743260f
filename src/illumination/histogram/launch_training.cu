// Training a codebook on GPUs: the same source, one thread a histogram; sums of whole numbers, in any order.
#include "illumination/histogram/unresolved.h"

namespace chiaro::kernel {
namespace {

struct AssignVector {
    CodebookView codebook;
    CodewordedVectors vectors;
    Unresolved left;
    CHIARO_DEVICE void operator()(std::int64_t i) const {
        store(i, near_codeword(codebook, vectors.histograms + i * codebook.bins, vectors.codewords[i]));
    }
    CHIARO_DEVICE void store(std::int64_t i, const FoundCodeword& found) const {
        vectors.codewords[i] = std::uint16_t(found.codeword), vectors.differences[i] = found.difference;
        if (!found.is_nearest) leave_unresolved(left, i);
    }
};
struct TryAllVector : AssignVector {
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        if (item >= std::int64_t(*left.count)) return;
        const std::int64_t i = left.which[item];
        store(i, codeword_of_all(codebook, vectors.histograms + i * codebook.bins,
                                 {vectors.codewords[i], vectors.differences[i], false}));
    }
};
struct AddUpVector {
    CodewordedVectors vectors;
    cuda::Count* sums;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        const std::int64_t i = item / vectors.bins;
        atomicAdd(sums + std::int64_t(vectors.codewords[i]) * vectors.bins + item % vectors.bins,
                  cuda::Count(vectors.histograms[item]));
    }
};

}  // namespace

template void run_on_gpu(cuda::Stream&, std::int64_t, const CountEdges&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const CountChosen&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const PlaceChosen&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const PickVectors&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const CodewordDifferences&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const RankNeighbours&);

void assign_vectors(cuda::Stream& stream, const CodebookView& codebook, const CodewordedVectors& vectors,
                    const Unresolved& left) {
    cuda::launch_items(stream, vectors.count, AssignVector{codebook, vectors, left});
    cuda::launch_items(stream, vectors.count, TryAllVector{{codebook, vectors, left}});
}
void add_up_vectors(cuda::Stream& stream, const CodewordedVectors& vectors, cuda::Count* sums) {
    cuda::launch_items(stream, std::int64_t(vectors.count) * vectors.bins, AddUpVector{vectors, sums});
}

}  // namespace chiaro::kernel
