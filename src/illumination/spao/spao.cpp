#include "illumination/spao/spao.h"

#include <optional>

#include "illumination/spao/fused.h"
#include "illumination/spao/gpu.h"
#include "illumination/spao/means.h"

namespace chiaro {
namespace {

/// How many of the levels are mipmaps before N-buffers begin.
int mip_levels(const SpaoSettings& settings) {
    switch (settings.filter) {
        case SpaoFilter::nbuffer:
            return 0;
        case SpaoFilter::mipmap:
            return settings.levels;
        default:
            return std::min(settings.mip_levels, settings.levels);
    }
}

/// `fill(cells)` for every row of every block.
template <class Fill>
CellValues fill_rows(const Device& device, const CellGrid& grid, const BlockMap& map, Progress& progress, Fill&& fill) {
    CellValues access(grid);
    const auto blocks = map.held();
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "spao", progress, [&](std::int64_t b, std::int64_t) {
        const auto [x, y, z] = map.cells(blocks[b], grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                fill(kernel::SpaoCells{x.first, x.second - x.first, j, k, access.data() + grid.index(x.first, j, k)});
    });
    progress.check();
    return access;
}

CellValues from_levels(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                       const BlockMap& blocks, StageTimer& timer, Progress& progress) {
    const SpaoLevels levels(device, opacity, mip_levels(settings), settings.levels, timer, progress);
    const kernel::StoredKernel kernel = stored_kernel(levels.view(), settings);
    const auto row = kernel::spao_functions_for(device.isa).stored_row;
    return timer("spao combine", [&] {
        return fill_rows(device, opacity.values.grid, blocks, progress,
                         [&](const kernel::SpaoCells& cells) { row(kernel, cells); });
    });
}

CellValues from_sums(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                     const BlockMap& blocks, StageTimer& timer, Progress& progress) {
    const SummedOpacity sums = timer("spao sums", [&] { return SummedOpacity(device, opacity.values, progress); });
    const kernel::ExactKernel kernel = exact_kernel(sums.view(), settings);
    return timer("spao combine", [&] {
        return fill_rows(device, opacity.values.grid, blocks, progress,
                         [&](const kernel::SpaoCells& cells) { kernel::access_row<float>(kernel, cells); });
    });
}

}  // namespace

bool is_fused(const SpaoSettings& settings) {
    // Look-ups that move with the normal need levels that can be asked for anywhere.
    const bool needs_levels = settings.model != SpaoModel::corrected && settings.normal_factor > 0;
    return settings.filter == SpaoFilter::automatic && !needs_levels;
}

CellValues spao_accessibility(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                              const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces) {
    const bool is_exact = settings.filter == SpaoFilter::exact;
    const bool is_stored = !is_fused(settings);
    std::optional<CellValues> access;
    const auto on_gpu = [&] {
        access.emplace(is_exact ? exact_on_gpu(device, opacity, settings, blocks, timer, progress)
                       : is_stored
                           ? stored_on_gpu(device, opacity, settings, mip_levels(settings), blocks, timer, progress)
                           : fused_on_gpu(device, opacity, settings, blocks, timer, progress, of_surfaces));
    };
    if (cuda::try_gpu(device, on_gpu)) return *std::move(access);
    if (is_exact) return from_sums(device, opacity, settings, blocks, timer, progress);
    if (is_stored) return from_levels(device, opacity, settings, blocks, timer, progress);
    return fused_sweep(device, opacity, settings, blocks, timer, progress, of_surfaces);
}

}  // namespace chiaro
