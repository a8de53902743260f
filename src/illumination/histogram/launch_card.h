// The table's kernels as a card has them, compiled by launch_words.cu; pointers are the card's.
#pragma once
#include "cuda/stream.h"
#include "illumination/histogram/table_kernel.h"

namespace chiaro::kernel {

/// Sixteen threads a word, then four.
void find_word_sums(cuda::Stream& stream, const WordTable& table);

}  // namespace chiaro::kernel
