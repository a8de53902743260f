// The order of SPAO's steps, written once. What a step does is told twice, for two shapes of work: the CPU takes rows
// of the blocks that hold something through its cache, by vectors of neighbours (fused.cpp, means.cpp); a GPU has a
// thread for each cell of a grid and many blocks at a time (gpu.cpp).
#pragma once
#include "core/threads.h"
#include "illumination/access.h"
#include "illumination/spao/fused.h"
#include "illumination/spao/means.h"

namespace chiaro {

/// Coarser grids, the shells of their corners from the coarsest on, then the cells.
template <class Sweep>
CellValues fused_steps(Sweep& sweep, const SpaoSettings& settings, StageTimer& timer) {
    timer("spao mipmaps", [&] { sweep.make_coarse_grids(); });
    for (int g = coarse_grids(settings); g > 0; --g) timer(name_of_cells(g), [&] { sweep.sweep_corners(g); });
    return timer(name_of_cells(0), [&] { return sweep.sweep_cells(); });
}

/// The cells, then mipmaps, then N-buffers up to level `top`.
template <class Levels>
void level_steps(Levels& levels, int mip_levels, int top, StageTimer& timer) {
    for (int level = 0; level <= top; ++level)
        timer(name_of_level(level), [&] {
            if (level == 0)
                levels.copy_opacity();
            else if (level <= mip_levels)
                levels.add_mipmap();
            else
                levels.add_nbuffer(1 << (level - mip_levels - 1));
        });
}

}  // namespace chiaro
