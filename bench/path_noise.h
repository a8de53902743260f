// How sure the reference is, by pixel.
#pragma once
#include "rows.h"

namespace chiaro::bench {

/// Adds the cases of samples and, where there are real volumes, of a brain.
void add_noise_cases(const Setup& setup, std::vector<Case>& cases);

}  // namespace chiaro::bench
