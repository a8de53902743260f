#include "io/zarr_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/threads.h"

namespace chiaro {
namespace {

/// Of up to eight voxels, one after the other.
template <class T>
class Mean {
public:
    void add(T value) {
        if constexpr (std::is_floating_point_v<T>)
            if (std::isnan(value)) return;
        sum_ += value, ++count_;
    }
    T value() const {
        if constexpr (std::is_floating_point_v<T>)
            return count_ ? T(sum_ / count_) : std::numeric_limits<T>::quiet_NaN();
        else
            return T((2 * sum_ + count_ + (sum_ < 0 ? 1 - 2 * count_ : 0)) / (2 * count_));  // to the nearest
    }

private:
    std::conditional_t<std::is_floating_point_v<T>, double, int> sum_ = 0;
    int count_ = 0;
};

template <class T>
class Largest {
public:
    void add(T value) {
        if (!has_one_ || value > largest_ || largest_ != largest_) largest_ = value, has_one_ = true;
    }
    T value() const { return largest_; }

private:
    T largest_{};
    bool has_one_ = false;
};

template <class Collect, class T>
void put_rows(const Block& finer, const std::array<int, 3>& factor, int z, const T* from, Block& coarser, T* to) {
    const auto& [first, size] = finer.box;
    const auto end_of = [](int n, int by) { return (n - 1) / by + 1; };
    const auto at = [](const VoxelBox& box, int x, int y, int level_z) {
        return (std::size_t(level_z) * std::size_t(box.size[1]) + std::size_t(y)) * std::size_t(box.size[0]) +
               std::size_t(x);
    };
    std::array<int, 3> shift{};
    for (std::size_t axis = 0; axis < 3; ++axis) shift[axis] = first[axis] / factor[axis] - coarser.box.first[axis];
    for (int y = 0; y < end_of(size[1], factor[1]); ++y)
        for (int x = 0; x < end_of(size[0], factor[0]); ++x) {
            Collect collected;
            for (int dz = z * factor[2]; dz < std::min((z + 1) * factor[2], size[2]); ++dz)
                for (int dy = y * factor[1]; dy < std::min((y + 1) * factor[1], size[1]); ++dy)
                    for (int dx = x * factor[0]; dx < std::min((x + 1) * factor[0], size[0]); ++dx)
                        collected.add(from[at(finer.box, dx, dy, dz)]);
            to[at(coarser.box, x + shift[0], y + shift[1], z + shift[2])] = collected.value();
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
            const T* from = reinterpret_cast<const T*>(finer.voxels.data());
            T* to = reinterpret_cast<T*>(coarser.voxels.data());
            parallel_for(threads, planes, 1, [&](std::int64_t z, std::int64_t) {
                if (by == LevelsBy::mean)
                    put_rows<Mean<T>>(finer, factor, int(z), from, coarser, to);
                else
                    put_rows<Largest<T>>(finer, factor, int(z), from, coarser, to);
            });
        }
    });
}

}  // namespace chiaro
