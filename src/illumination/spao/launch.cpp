#include "illumination/spao/functions.h"

namespace chiaro::kernel::CHIARO_ISA {

SpaoFunctions spao_functions() {
    return {
        [](SpaoTile& tile, const SpaoBlock& block, const SpaoOutput& to) {
            find_means_from_cells(tile);
            spao_block<true, NativeLanes>(block, to);
        },
        [](SpaoTile& tile, const SpaoBlock& block, const SpaoOutput& to) {
            find_means_from_corners(tile);
            spao_block<false, NativeLanes>(block, to);
        },
        [](const MipRows& rows, int n, std::uint16_t* to) { mip_row(rows, n, to); },
        [](const MipRows& rows, int n, std::uint16_t* to) { crossing_row(rows, n, to); },
        [](const NBufferRows& rows, std::uint16_t* scratch, std::uint16_t* to) { nbuffer_row(rows, scratch, to); },
        [](const StoredKernel& kernel, const SpaoCells& cells) { access_row<NativeLanes>(kernel, cells); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA
