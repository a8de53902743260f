// The kernels of local histograms as a GPU has them, compiled by launch_*.cu; pointers are the GPU's.
#pragma once
#include "cuda/counters.h"
#include "illumination/histogram/choice_kernel.h"
#include "illumination/histogram/codeword_kernel.h"
#include "illumination/histogram/fast_batch.h"
#include "illumination/histogram/neighbour_kernel.h"
#include "illumination/histogram/normal_offset_kernel.h"
#include "illumination/histogram/slab_kernel.h"
#include "illumination/histogram/table_kernel.h"

namespace chiaro::kernel {

/// Histograms and the words that they belong to.
struct CodewordedVectors {
    const std::int16_t* histograms;
    std::int32_t count, bins;
    std::uint16_t* codewords;
    std::int32_t* differences;
};

/// Histograms whose words' neighbours did not tell the nearest, in any order: those are sought side by side, as one
/// thread that tries all words keeps its neighbours waiting.
struct Unresolved {
    cuda::Count* count;  ///< 0 at first
    std::uint32_t* which;
};

struct PickVectors {
    const std::int16_t* vectors;
    std::int32_t bins;
    const std::uint32_t* which;
    std::int16_t* list;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        list[item] = vectors[which[item / bins] * std::int64_t(bins) + item % bins];
    }
};

/// M0 and P of blocks; then histograms of a slab of each. `shape` is what the blocks have in common.
CHIARO_LAUNCHER void fast_sums(cuda::Stream& stream, FastBatch batch, const FastBlock& shape, std::int64_t blocks);
CHIARO_LAUNCHER void fast_cells(cuda::Stream& stream, const FastBatch& batch, std::int64_t blocks);

/// The nearest word of each of a slab's nodes.
CHIARO_LAUNCHER void assign_slab(cuda::Stream& stream, const AssignSlab& assign, const Unresolved& left,
                                 std::int64_t blocks);

/// assign_each, a thread for each of `count` histograms; then the sums of each word's, zero at first, a thread for each
/// bin of each.
CHIARO_LAUNCHER void assign_vectors(cuda::Stream& stream, const CodebookView& codebook,
                                    const CodewordedVectors& vectors, const Unresolved& left);
CHIARO_LAUNCHER void add_up_vectors(cuda::Stream& stream, const CodewordedVectors& vectors, cuda::Count* sums);

CHIARO_LAUNCHER void count_members(cuda::Stream& stream, const CountMembers& count, std::int64_t members);
CHIARO_LAUNCHER void add_up_members(cuda::Stream& stream, const AddUpMembers& add_up, std::int64_t codewords);

/// Sixteen threads a word, then four.
CHIARO_LAUNCHER void find_codeword_sums(cuda::Stream& stream, const CodewordTable& table);

}  // namespace chiaro::kernel
