// Whether a volume is noisy enough to be smoothed, and what is thin survives it.
#include <algorithm>
#include <atomic>
#include <limits>

#include "classify/kinds.h"
#include "core/threads.h"
#include "volume/device_view.h"
#include "volume/splined.h"

namespace chiaro {
namespace {

constexpr double surviving = 0.98;

/// Lines of voxels that hold something, of all along one axis.
struct Covered {
    std::int64_t along_x = 0, along_z = 0;

    bool survives(const Covered& before) const {
        const auto nearly_all = [](std::int64_t now, std::int64_t then) {
            return double(now) >= surviving * double(then);
        };
        return nearly_all(along_x, before.along_x) && nearly_all(along_z, before.along_z);
    }
};

template <class Voxel>
Covered covered(const DeviceVolume::Data& volume, const Kinds& kinds) {
    std::vector<char> is_something;  // by stored value, where these are few
    if constexpr (sizeof(Voxel) <= 2)
        for (int stored = 0; stored <= std::numeric_limits<Voxel>::max(); ++stored)
            is_something.push_back(kinds.of(float(stored)) == 2);
    const auto shows = [&](Voxel stored) -> bool {
        if constexpr (sizeof(Voxel) <= 2) return is_something[stored];
        return kinds.of(float(stored)) == 2;
    };
    const auto& n = volume.dimensions;
    const auto* voxels = reinterpret_cast<const Voxel*>(volume.bricks.data());
    std::atomic<std::int64_t> along_x = 0, along_z = 0;
    parallel_for(volume.device.threads, n[1], 1, [&](std::int64_t y, std::int64_t) {
        std::vector<char> columns(n[0], 0);
        for (int z = 0; z < n[2]; ++z) {
            char is_covered = 0;
            for (int x = 0; x < n[0]; x += brick_edge) {
                const Voxel* row = voxels + voxel_index(volume, x, int(y), z);
                for (int i = 0; i < std::min(brick_edge, n[0] - x); ++i)
                    if (shows(row[i])) is_covered = columns[std::size_t(x + i)] = 1;
            }
            along_x += is_covered;
        }
        along_z += std::count(columns.begin(), columns.end(), 1);
    });
    return {along_x, along_z};
}

}  // namespace

Interpolation interpolation_for(const Medium& medium, double noise, const Progress& progress) {
    if (noise <= worth_smoothing || is_mixed(medium.data())) return Interpolation::cubic;
    const DeviceVolume& volume = medium.data().volume;
    const Kinds kinds(medium.data());
    const DeviceVolume smoothed = splined(volume, false, progress);
    const bool survives = with_stored_voxel(volume.data(), [&](auto zero) {
        using Voxel = decltype(zero);
        return covered<Voxel>(smoothed.data(), kinds).survives(covered<Voxel>(volume.data(), kinds));
    });
    progress.check();
    return survives ? Interpolation::smooth : Interpolation::cubic;
}

}  // namespace chiaro
