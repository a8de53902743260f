#include "kernel/launch.h"
#include "volume/spline_functions.h"

namespace chiaro::kernel::CHIARO_ISA {
namespace {

template <class Code>
CodeFunctions<Code> functions_of() {
    return {[](const float* values, int n, const Coding& coding, Code* codes) { to_codes(values, n, coding, codes); },
            [](const Code* brick, int slices, unsigned layers, CellBounds& bounds) {
                RefinedBrick<NativeLanes>().find(brick, slices, layers, bounds);
            }};
}

}  // namespace

SplineFunctions spline_functions() {
    return {
        functions_of<std::uint8_t>(),
        functions_of<std::uint16_t>(),
        functions_of<float>(),
        [](const Lines& lines, const float* factors) { to_coefficients(lines, factors); },
        [](const Lines& lines, float* before) { smooth(lines, before); },
        [](const float* numbers, int n, float& low, float& high) { find_range<NativeLanes>(numbers, n, low, high); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA
