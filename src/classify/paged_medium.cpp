#include "classify/paged_medium.h"

#include <algorithm>
#include <cmath>

#include "core/threads.h"

namespace chiaro {
namespace {

/// The code of each cell of a brick, as if there was nothing beyond it: rays leave its cubes with the brick.
bool code_cells(const CellRanges& ranges, const RangeTest& is_visible, std::uint8_t* codes) {
    const std::vector<std::uint8_t> found = make_occupancy(ranges, std::cref(is_visible), 1);
    bool shows = false;
    for (int c = 0; c < kernel::BrickTable::cells; ++c) {
        codes[c] = found[std::size_t(c)];
        shows = shows || (codes[c] & 1);
    }
    return shows;
}

/// Cells in which a medium shows something, and all beside them.
class ShownCells {
public:
    explicit ShownCells(const Medium::Data& medium) : count_(medium.volume.data().cells.count) {
        shown_.resize(medium.cell_count());
        for (std::size_t c = 0; c < shown_.size(); ++c) shown_[c] = medium.cells[c] & 1;
        std::ptrdiff_t stride = 1;
        for (const int n : count_) {
            widen(stride, n, medium.volume.data().device.threads);
            stride *= n;
        }
    }

    const std::array<int, 3>& count() const { return count_; }
    bool any(const std::array<std::array<int, 2>, 3>& range) const {
        for (int z = range[2][0]; z <= range[2][1]; ++z)
            for (int y = range[1][0]; y <= range[1][1]; ++y)
                for (int x = range[0][0]; x <= range[0][1]; ++x)
                    if (shown_[(std::size_t(z) * count_[1] + y) * count_[0] + x]) return true;
        return false;
    }

private:
    /// Along an axis of n cells, `stride` apart.
    void widen(std::ptrdiff_t stride, int n, int threads) {
        const std::vector<std::uint8_t> from = shown_;
        parallel_for(threads, std::int64_t(from.size()), 1 << 16, [&](std::int64_t c, std::int64_t end) {
            for (; c < end; ++c) {
                const auto at = c / stride % n;
                const std::uint8_t* cell = from.data() + c;
                shown_[std::size_t(c)] = cell[0] | (at > 0 ? cell[-stride] : 0) | (at + 1 < n ? cell[stride] : 0);
            }
        });
    }

    std::array<int, 3> count_;
    std::vector<std::uint8_t> shown_;
};

/// Of each brick along each axis, which cells of the coarse volume it lies in.
using CellsOfBricks = std::array<std::vector<std::array<int, 2>>, 3>;
CellsOfBricks cells_of_bricks(const LevelPages& pages, const std::array<int, 3>& count) {
    CellsOfBricks cells;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int b = 0; b < pages.bricks[axis]; ++b) {
            const auto cell = [&](int voxel) {
                const double at = (voxel * pages.per_voxel[axis] + pages.shift[axis]) / cell_edge;
                return int(std::clamp(std::floor(at), 0.0, double(count[axis] - 1)));
            };
            cells[axis].push_back({cell(b * brick_edge), cell((b + 1) * brick_edge)});
        }
    return cells;
}

}  // namespace

Medium paged_medium(PagedLevel& level, const Medium& whole, const BrickRanges* exact) {
    const Medium::Data& looks = whole.data();
    auto data = std::make_shared<Medium::Data>();
    data->volume = level.volume();
    data->table = looks.table;
    data->shape = looks.shape;
    data->cells = {0, 0};
    data->occupied_fraction = looks.occupied_fraction;
    data->lit_as = looks.shared_from_this();

    const bool is_iso = looks.shape.mode == Mode::iso;
    const auto is_visible = std::make_shared<const RangeTest>(
        is_iso ? crossed_range(looks.volume.data(), looks.shape.iso) : visible_range(data->table));
    const BrickLooks of_bricks{
        [is_visible](const CellRanges& ranges, std::uint8_t* codes) { return code_cells(ranges, *is_visible, codes); },
        [is_visible](float low, float high) { return (*is_visible)(low, high); }, is_iso};
    if (exact && level.level() == 0) {
        const auto shows = [&](std::int64_t b) {
            return (*is_visible)(exact->low[std::size_t(b)], exact->high[std::size_t(b)]);
        };
        level.classify(of_bricks, shows);
        return Medium(std::move(data));
    }
    const ShownCells shown(looks);
    const CellsOfBricks cells = cells_of_bricks(level.pages(), shown.count());
    const auto [nx, ny, nz] = level.pages().bricks;
    const auto may_show = [&, nx = nx, ny = ny](std::int64_t b) {
        return shown.any(
            {cells[0][std::size_t(b % nx)], cells[1][std::size_t(b / nx % ny)], cells[2][std::size_t(b / nx / ny)]});
    };
    level.classify(of_bricks, may_show);
    return Medium(std::move(data));
}

}  // namespace chiaro
