#include "illumination/cells/surface_share.h"

#include "core/threads.h"
#include "illumination/cells/outward.h"

namespace chiaro {
namespace {

/// 0 beyond the grid, as opacity is.
float opacity_at(const CellValues& opacity, int x, int y, int z) {
    return opacity.grid.holds(x, y, z) ? float(opacity.data()[opacity.grid.index(x, y, z)]) / cell_one : 0;
}

kernel::Vec3<float> normal_at(const CellValues& opacity, int x, int y, int z) {
    return {opacity_at(opacity, x - 1, y, z) - opacity_at(opacity, x + 1, y, z),
            opacity_at(opacity, x, y - 1, z) - opacity_at(opacity, x, y + 1, z),
            opacity_at(opacity, x, y, z - 1) - opacity_at(opacity, x, y, z + 1)};
}

}  // namespace

CellValues surface_shares(const Device& device, CellValues access, const CellValues& opacity, double normal_factor,
                          const BlockMap& map, Progress& progress) {
    const CellGrid& grid = access.grid;
    std::uint16_t* cells = access.data();
    const auto blocks = map.held();
    parallel_for(
        device.threads, std::int64_t(blocks.size()), 1, "surfaces", progress, [&](std::int64_t b, std::int64_t) {
            const auto [x, y, z] = map.cells(blocks[std::size_t(b)], grid.count);
            for (int k = z.first; k < z.second; ++k)
                for (int j = y.first; j < y.second; ++j)
                    for (int i = x.first; i < x.second; ++i) {
                        std::uint16_t& cell = cells[grid.index(i, j, k)];
                        const float q = kernel::outward_share(normal_at(opacity, i, j, k), float(normal_factor));
                        cell = cell_value(double(cell) / (double(cell_one) * double(1 + q)));
                    }
        });
    progress.check();
    return access;
}

}  // namespace chiaro
