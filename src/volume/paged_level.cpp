#include "volume/paged_level.h"

#include <chiaro/error.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <numeric>

#include "core/threads.h"
#include "volume/brick_curve.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"
#include "volume/fill_brick.h"

namespace chiaro {
namespace {

constexpr std::int32_t absent = kernel::BrickTable::absent, empty = absent - 1;
constexpr std::size_t cells = kernel::BrickTable::cells;
constexpr std::size_t max_faults = 3;

template <class Source>
Conversion<Source> conversion_of(const DeviceVolume::Data& like) {
    Conversion<Source> c;
    if constexpr (std::is_integral_v<Source>)
        c.shift = std::numeric_limits<Source>::min();
    else
        c.shift = Source(like.shift), c.low = Source(like.stored_min) + c.shift,
        c.high = Source(like.stored_max) + c.shift;
    return c;
}

/// Calls f with a value of the source's type and one of the type that it is stored as.
template <class Function>
void with_types(VoxelType source, Function&& f) {
    with_voxel_type(source, [&](auto stored) {
        using Stored = decltype(stored);
        if constexpr (std::is_same_v<Stored, float>)
            f(stored, stored);
        else if constexpr (sizeof(Stored) <= 2)
            f(stored, std::make_unsigned_t<Stored>{});
    });
}

}  // namespace

std::size_t PagedLevel::bytes_of_brick(VoxelType stored) {
    return brick_voxels * size_of(stored) + cells * (2 * sizeof(float) + 1);
}

std::int32_t PagedLevel::max_room(const DeviceVolume& coarse) {
    const std::size_t taken = coarse.data().bricks.size() / size_of(coarse.data().stored);
    return std::int32_t((UINT32_MAX - 8 - std::min(taken, std::size_t(UINT32_MAX) - 8)) / brick_voxels);
}

PagedLevel::PagedLevel(std::shared_ptr<const BrickSource> source, int level, const DeviceVolume& coarse,
                       std::int32_t room)
    : source_(std::move(source)),
      level_(level),
      data_(std::make_shared<DeviceVolume::Data>()),
      pages_(std::make_shared<LevelPages>()),
      volume_(data_) {
    const DeviceVolume::Data& like = coarse.data();
    if (like.scale != source_->header().slope)
        throw Error(ErrorCode::input,
                    source_->header().source + " holds numbers that floats cannot: it cannot be read brick by brick");
    const SourceLevel& grid = source_->levels()[std::size_t(level)];
    data_->describe_as(like);
    data_->dimensions = grid.dimensions;
    data_->geometry = grid.geometry;
    data_->stored_min = like.stored_min, data_->stored_max = like.stored_max;
    const std::size_t slot_bytes = std::size_t(room) * brick_voxels * size_of(like.stored);
    data_->bricks = VoxelBuffer(slot_bytes + like.bricks.size());
    std::memcpy(data_->bricks.data() + slot_bytes, like.bricks.data(), like.bricks.size());
    pages_->first_coarse = std::uint32_t(std::size_t(room) * brick_voxels);
    data_->pages = pages_;
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
        count *= std::size_t(pages_->bricks[axis] = brick_count(grid.dimensions[axis]));
    pages_->coarse = coarse;
    pages_->slots.assign(count, absent);
    pages_->seen.assign(count, 0);
    pages_->codes = VoxelBuffer(std::size_t(room) * cells + kernel::spare_bytes);
    const Vec3 shift = like.geometry.voxel_from_world(grid.geometry.origin_mm);
    for (int axis = 0; axis < 3; ++axis) {
        pages_->per_voxel[std::size_t(axis)] = grid.geometry.spacing_mm[axis] / like.geometry.spacing_mm[axis];
        pages_->shift[std::size_t(axis)] = shift[axis];
    }
    ranges_ = VoxelBuffer(std::size_t(room) * cells * 2 * sizeof(float));
    brick_of_.assign(std::size_t(room), -1);
    is_lost_.assign(count, 0);
    for (std::int32_t slot = room; slot-- > 0;) free_.push_back(slot);
}

std::array<int, 3> PagedLevel::place_of(std::int64_t brick) const {
    const auto [nx, ny, nz] = pages_->bricks;
    return {int(brick % nx), int(brick / nx % ny), int(brick / nx / ny)};
}

CellRanges PagedLevel::ranges_of(std::int32_t slot) const {
    constexpr int edge = brick_edge / cell_edge;
    const auto* low = reinterpret_cast<const float*>(ranges_.data()) + std::size_t(slot) * cells * 2;
    return {{edge, edge, edge}, {low, low + cells}, {low + cells, low + 2 * cells}};
}

bool PagedLevel::code(std::int32_t slot) {
    return looks_.code(ranges_of(slot),
                       reinterpret_cast<std::uint8_t*>(pages_->codes.data()) + std::size_t(slot) * cells);
}

void PagedLevel::fill(std::int64_t brick, std::int32_t slot) {
    const std::array<int, 3> at = place_of(brick);
    const VoxelBox box = box_of_brick(at, data_->dimensions);
    with_types(source_->header().type, [&](auto source_zero, auto stored_zero) {
        using Source = decltype(source_zero);
        using Stored = decltype(stored_zero);
        std::vector<Source> voxels(std::size_t(box.size[0]) * box.size[1] * box.size[2]);
        source_->read(level_, box, reinterpret_cast<std::byte*>(voxels.data()));
        auto* out = reinterpret_cast<Stored*>(data_->bricks.data()) + std::size_t(slot) * brick_voxels;
        const BoxedVoxels<Source> from{voxels.data(), box};
        fill_brick(from, conversion_of<Source>(pages_->coarse.data()), at, brick_row, out);
        CellRanges ranges = ranges_of(slot);
        fill_cells(out, {0, 0, 0}, brick_row, ranges);
        auto* kept = reinterpret_cast<float*>(ranges_.data()) + std::size_t(slot) * cells * 2;
        std::copy(ranges.high.begin(), ranges.high.end(), std::copy(ranges.low.begin(), ranges.low.end(), kept));
    });
}

void PagedLevel::classify(BrickLooks looks, const std::function<bool(std::int64_t)>& may_show) {
    looks_ = std::move(looks);
    auto& slots = pages_->slots;
    parallel_for(data_->device.threads, std::int64_t(slots.size()), 1 << 14, [&](std::int64_t b, std::int64_t end) {
        for (; b < end; ++b)
            if (slots[std::size_t(b)] < 0) slots[std::size_t(b)] = may_show(b) ? absent : empty;
    });
    for (const auto& [brick, range] : let_go_)
        if (std::int32_t& slot = slots[std::size_t(brick)]; slot == absent && !looks_.shows(range[0], range[1]))
            slot = empty;
    for (std::size_t slot = 0; slot < brick_of_.size(); ++slot)
        if (brick_of_[slot] >= 0) code(std::int32_t(slot));
}

void PagedLevel::forget_seen() { std::fill(pages_->seen.begin(), pages_->seen.end(), std::uint8_t(0)); }

std::vector<std::int64_t> PagedLevel::missing() const {
    std::vector<std::int64_t> bricks;
    for (std::size_t b = 0; b < pages_->slots.size(); ++b)
        if (pages_->seen[b] && pages_->slots[b] == absent && !is_lost_[b]) bricks.push_back(std::int64_t(b));
    std::ranges::sort(bricks, {}, [this](std::int64_t brick) { return place_on_curve(place_of(brick)); });
    return bricks;
}

/// Lets go of bricks that were not seen.
void PagedLevel::take_free() {
    for (std::size_t slot = brick_of_.size(); slot-- > 0;) {
        const std::int64_t brick = brick_of_[slot];
        if (brick < 0 || pages_->seen[std::size_t(brick)]) continue;
        pages_->slots[std::size_t(brick)] = absent;
        brick_of_[slot] = -1;
        free_.push_back(std::int32_t(slot));
    }
}

/// Numbers of bricks in the order of the boxes that the source reads at the least cost: what it decodes for one serves
/// its neighbours before it is let go.
std::vector<std::size_t> PagedLevel::by_pieces(std::span<const std::int64_t> bricks) const {
    const std::array<int, 3> piece = source_->piece(level_);
    std::vector<std::size_t> order(bricks.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, {}, [&](std::size_t i) {
        const auto [x, y, z] = place_of(bricks[i]);
        return std::array{z * brick_edge / piece[2], y * brick_edge / piece[1], x * brick_edge / piece[0]};
    });
    return order;
}

bool PagedLevel::read(const std::vector<std::int64_t>& bricks, Progress& progress) {
    std::mutex telling;
    for (std::size_t done = 0; done < bricks.size();) {
        if (free_.size() < bricks.size() - done) take_free();
        if (free_.empty()) return false;
        const std::size_t count = std::min(free_.size(), bricks.size() - done);
        const std::vector<std::int32_t> slots(free_.end() - std::ptrdiff_t(count), free_.end());
        std::vector<std::int32_t> entries(count, absent);
        const std::vector<std::size_t> order = by_pieces(std::span(bricks).subspan(done, count));
        std::atomic<std::size_t> next{0};
        const auto fill_next = [&](std::int64_t, std::int64_t) {
            const std::size_t i = order[next++];
            const std::int64_t brick = bricks[done + i];
            try {
                fill(brick, slots[i]);
                const bool shows = code(slots[i]);
                entries[i] = shows || looks_.keep_empty ? slots[i] : empty;
            } catch (const Error& error) {
                if (error.code() == ErrorCode::interrupted) return;
                is_lost_[std::size_t(brick)] = 1;
                const std::lock_guard lock(telling);
                ++lost_;
                if (faults_.size() < max_faults &&
                    std::find(faults_.begin(), faults_.end(), error.what()) == faults_.end())
                    faults_.push_back(error.what());
            }
        };
        parallel_for(data_->device.threads, std::int64_t(count), 1, "bricks", progress, fill_next);
        free_.resize(free_.size() - count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t brick = bricks[done + i];
            pages_->slots[std::size_t(brick)] = entries[i];
            if (entries[i] >= 0)
                brick_of_[std::size_t(slots[i])] = brick;
            else
                free_.push_back(slots[i]);
            if (entries[i] == empty) {
                const CellRanges ranges = ranges_of(slots[i]);
                let_go_[brick] = {std::ranges::min(ranges.low), std::ranges::max(ranges.high)};
            }
            bricks_read_ += entries[i] != absent || is_lost_[std::size_t(brick)];
        }
        progress.check();
        done += count;
    }
    return true;
}

std::size_t PagedLevel::bricks_there() const { return brick_of_.size() - free_.size(); }

}  // namespace chiaro
