#include "io/zarr_pyramid.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/threads.h"

namespace chiaro {
namespace {

/// Of one, two, four or eight voxels, in their order. How many is known when compiling, so that many are found at a
/// time.
struct Mean {
    template <class T, std::size_t count>
    static T of(const std::array<T, count>& voxels) {
        if constexpr (std::is_floating_point_v<T>) {
            double sum = 0, numbers = 0;
            for (const T voxel : voxels) {
                const bool is_number = voxel == voxel;
                sum += is_number ? double(voxel) : 0.0, numbers += is_number ? 1.0 : 0.0;
            }
            return numbers > 0 ? T(sum / numbers) : std::numeric_limits<T>::quiet_NaN();
        } else {
            std::conditional_t<sizeof(T) == 1, std::int16_t, std::int32_t> sum = count / 2;  // to the nearest
            for (const T voxel : voxels) sum += voxel;
            return T(sum >> std::countr_zero(count));
        }
    }
};

struct Largest {
    template <class T, std::size_t count>
    static T of(const std::array<T, count>& voxels) {
        T largest = voxels[0];
        for (const T voxel : voxels) largest = voxel > largest || largest != largest ? voxel : largest;
        return largest;
    }
};

/// `count` voxels of a row of the coarser level, of the finer one's `rows`.
template <class Rule, std::size_t rows, std::size_t along, class T>
void combine(const std::array<const T*, 4>& from, std::size_t count, T* to) {
    for (std::size_t x = 0; x < count; ++x) {
        std::array<T, rows * along> voxels;
        for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = from[i / along][x * along + i % along];
        to[x] = Rule::of(voxels);
    }
}

template <class Rule, std::size_t rows, class T>
void put_row(std::array<const T*, 4> from, std::size_t size, int factor, T* to) {
    if (factor == 1) return combine<Rule, rows, 1>(from, size, to);
    combine<Rule, rows, 2>(from, size / 2, to);
    for (std::size_t row = 0; row < rows; ++row) from[row] += size - 1;
    if (size % 2) combine<Rule, rows, 1>(from, 1, to + size / 2);
}

template <class Rule, class T>
void put_plane(const Block& finer, const std::array<int, 3>& factor, int z, Block& coarser) {
    const auto& [first, size] = finer.box;
    const auto row_of = [](const Block& block, int x, int y, int level_z) {
        const auto& n = block.box.size;
        return (std::size_t(level_z) * std::size_t(n[1]) + std::size_t(y)) * std::size_t(n[0]) + std::size_t(x);
    };
    const T* all = reinterpret_cast<const T*>(finer.voxels.data());
    std::array<int, 3> shift{};
    for (std::size_t axis = 0; axis < 3; ++axis) shift[axis] = first[axis] / factor[axis] - coarser.box.first[axis];
    for (int y = 0; y * factor[1] < size[1]; ++y) {
        std::array<const T*, 4> from{};
        std::size_t rows = 0;
        for (int dz = z * factor[2]; dz < std::min((z + 1) * factor[2], size[2]); ++dz)
            for (int dy = y * factor[1]; dy < std::min((y + 1) * factor[1], size[1]); ++dy)
                from[rows++] = all + row_of(finer, 0, dy, dz);
        T* to = reinterpret_cast<T*>(coarser.voxels.data()) + row_of(coarser, shift[0], y + shift[1], z + shift[2]);
        const auto put = rows == 4 ? put_row<Rule, 4, T> : rows == 2 ? put_row<Rule, 2, T> : put_row<Rule, 1, T>;
        put(from, std::size_t(size[0]), factor[0], to);
    }
}

}  // namespace

std::vector<PyramidLevel> pyramid_of(const SourceLevel& finest) {
    std::vector<PyramidLevel> levels{{finest.dimensions, finest.geometry, {}, {1, 1, 1}}};
    while (*std::ranges::max_element(levels.back().dimensions) > zarr_chunk_edge) {
        const PyramidLevel& finer = levels.back();
        PyramidLevel level = finer;
        Vec3 stride, first;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool is_wide = finer.geometry.spacing_mm[int(axis)] >= 2 * finer.geometry.smallest_spacing_mm();
            level.factor[axis] = is_wide || finer.dimensions[axis] == 1 ? 1 : 2;
            level.dimensions[axis] = (finer.dimensions[axis] - 1) / level.factor[axis] + 1;
            stride[int(axis)] = level.factor[axis], first[int(axis)] = (level.factor[axis] - 1) / 2.0;
        }
        if (level.factor == std::array{1, 1, 1}) break;
        for (int axis = 0; axis < 3; ++axis) level.shift_mm[axis] += first[axis] * finer.geometry.spacing_mm[axis];
        level.geometry = every(finer.geometry, stride, first);
        levels.push_back(level);
    }
    return levels;
}

void put_coarser(const Block& finer, VoxelType type, const std::array<int, 3>& factor, LevelsBy by, int threads,
                 Block& coarser) {
    const int planes = (finer.box.size[2] - 1) / factor[2] + 1;
    with_voxel_type(type, [&](auto zero) {
        using T = decltype(zero);
        if constexpr (sizeof(T) <= 2 || std::is_same_v<T, float>) {
            const auto put = by == LevelsBy::mean ? put_plane<Mean, T> : put_plane<Largest, T>;
            parallel_for(threads, planes, 1,
                         [&](std::int64_t z, std::int64_t) { put(finer, factor, int(z), coarser); });
        }
    });
}

}  // namespace chiaro
