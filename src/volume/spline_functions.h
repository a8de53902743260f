// What of splines is compiled once per instruction set.
#pragma once
#include "volume/spline_kernel.h"

namespace chiaro::kernel {

/// Of coefficients that are stored as `Code`.
template <class Code>
struct CodeFunctions {
    void (*to_codes)(const float* values, int n, const Coding&, Code* codes);
    void (*find_bounds)(const Code* brick, int slices, unsigned layers, CellBounds&);
};

struct SplineFunctions : CodeFunctions<std::uint8_t>, CodeFunctions<std::uint16_t>, CodeFunctions<float> {
    void (*to_coefficients)(const Lines&, const float* factors);
    void (*smooth)(const Lines&, float* before);
    void (*find_range)(const float* numbers, int n, float& low, float& high);
};

}  // namespace chiaro::kernel
