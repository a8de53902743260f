// What of SPAO is compiled once per instruction set.
#pragma once
#include "illumination/spao/kernel.h"
#include "illumination/spao/levels.h"
#include "illumination/spao/stored.h"

namespace chiaro::kernel {

struct SpaoFunctions {
    void (*cells)(SpaoTile&, const SpaoBlock&, const SpaoOutput&);
    void (*corners)(SpaoTile&, const SpaoBlock&, const SpaoOutput&);
    void (*mip_row)(const MipRows&, int n, std::uint16_t* to);
    void (*crossing_row)(const MipRows&, int n, std::uint16_t* to);
    void (*nbuffer_row)(const NBufferRows&, std::uint16_t* scratch, std::uint16_t* to);
    void (*stored_row)(const StoredKernel&, const SpaoCells&);
};

}  // namespace chiaro::kernel
