#include "illumination/cells/spare_values.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "core/threads.h"
#include "volume/spare_memory.h"

namespace chiaro {
namespace {

/// Of what is mapped anew each page costs a fault and is filled with zeros. Larger values are given back.
constexpr std::size_t largest_kept = (std::size_t(256) << 20) + 64;

struct WrittenValues {
    std::array<int, 3> count{0, 0, 0};
    VoxelBuffer memory;
    BlockMap written{{0, 0, 0}};  ///< elsewhere 0
};

/// Whether one grid has every other cell of the other, as drafts of a large volume have.
bool is_every_other(const std::array<int, 3>& some, const std::array<int, 3>& all) {
    const auto is_half = [](int n, int of) { return std::abs(2 * n - of) <= 2; };
    return std::equal(some.begin(), some.end(), all.begin(), is_half);
}

class SpareValues {
public:
    /// Where nothing is kept for the grid, what is kept for those of other volumes is given back.
    WrittenValues take(const std::array<int, 3>& count) {
        const std::lock_guard lock(mutex_);
        for (WrittenValues& one : newest_first_)
            if (one.count == count) return std::exchange(one, WrittenValues());
        for (WrittenValues& one : newest_first_)
            if (!is_every_other(one.count, count) && !is_every_other(count, one.count)) one = WrittenValues();
        return {};
    }
    void keep(WrittenValues values) {
        const std::lock_guard lock(mutex_);
        if (newest_first_[0].memory.size()) std::swap(newest_first_[0], newest_first_[1]);
        std::swap(newest_first_[0], values);
    }

private:
    std::mutex mutex_;
    std::array<WrittenValues, 2> newest_first_;
};

/// Never destroyed: values may go at the end of the process.
SpareValues& spare_values() {
    static SpareValues& spare = *new SpareValues;
    return spare;
}

/// A piece of a block is 0 again.
void clear_piece(std::uint16_t* cells, const std::array<int, 3>& count, const std::array<int, 3>& first) {
    const auto end = [&](int axis, int size) { return std::min(first[axis] + size, count[axis]); };
    const int x1 = end(0, BlockPieces::width), y1 = end(1, BlockPieces::height), z1 = end(2, BlockPieces::height);
    if (first[0] >= x1) return;
    for (int z = first[2]; z < z1; ++z)
        for (int y = first[1]; y < y1; ++y)
            std::fill_n(cells + (std::size_t(z) * count[1] + y) * count[0] + first[0], x1 - first[0], std::uint16_t(0));
}

/// What was written of a block and will not be written again.
void clear_rest(WrittenValues& old, const BlockMap& written, std::size_t block) {
    auto* cells = reinterpret_cast<std::uint16_t*>(old.memory.data());
    const auto [x, y, z] = old.written.at(block);
    const BlockPieces none{};
    const BlockPieces &was = old.written.pieces_of(block),
                      &will = written.holds[block] ? written.pieces_of(block) : none;
    constexpr int height = BlockPieces::height, rows = block_edge / height;
    for (int k = 0; k < rows; ++k)
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < block_edge / BlockPieces::width; ++i)
                if (was.bits[k][j] & ~will.bits[k][j] & 1 << i)
                    clear_piece(cells, old.count,
                                {x * block_edge + i * BlockPieces::width, y * block_edge + j * height,
                                 z * block_edge + k * height});
}

}  // namespace

CellValues values_to_write(const CellGrid& grid, const BlockMap& written, bool use_small_pages, int threads) {
    const std::size_t bytes = CellValues::bytes_of(grid);
    if (bytes > largest_kept) {
        CellValues values(grid);
        if (use_small_pages) values.buffer.use_small_pages();
        return values;
    }
    WrittenValues values = spare_values().take(grid.count);
    if (values.memory.size()) {
        const auto blocks = values.written.held();
        parallel_for(threads, std::int64_t(blocks.size()), 1,
                     [&](std::int64_t i, std::int64_t) { clear_rest(values, written, blocks[std::size_t(i)]); });
    } else {
        values.memory = VoxelBuffer(bytes);
        if (use_small_pages) values.memory.use_small_pages();
    }
    return {grid, lent(std::move(values.memory), [count = grid.count, written](VoxelBuffer back) {
                spare_values().keep({count, std::move(back), written});
            })};
}

}  // namespace chiaro
