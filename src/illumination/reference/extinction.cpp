#include "illumination/reference/extinction.h"

#include <chiaro/error.h>

#include <mutex>

#include "classify/clip.h"
#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

constexpr double most_opaque = 1 - 1e-7;  ///< κ = -ln(1 - α) stays finite

double extinction_of(double opacity) { return -std::log1p(-std::min(opacity, most_opaque)); }

/// κ of one cell, from the volume or, of isosurfaces, from how much of the cell lies inside.
template <class Voxel>
class CellExtinction {
public:
    CellExtinction(const Medium::Data& medium, const CellOpacity& opacity)
        : view_(view_of<Voxel>(medium.volume.data())),
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)),
          table_(extinction_table(medium, opacity.values.grid)),
          opacity_(opacity.values),
          is_iso_(medium.shape.mode == Mode::iso) {}

    float operator()(int x, int y, int z) const {
        if (is_iso_) return float(extinction_of(opacity_.data()[opacity_.grid.index(x, y, z)] / double(cell_one)));
        const Vec3 p = opacity_.grid.voxel_of(x, y, z);
        for (const HalfSpace& half : kept_)
            if (dot(half.normal, p) > half.d) return 0;
        const auto at = view_.clamp(kernel::Vec3<float>(float(p.x), float(p.y), float(p.z)));
        return table_(view_.value(view_.locate(at, view_.voxel(at))));
    }

private:
    const kernel::VolumeView<Voxel> view_;
    const std::vector<HalfSpace> kept_;
    const ExtinctionTable table_;
    const CellValues& opacity_;
    const bool is_iso_;
};

ExtinctionTable inside_surfaces(const Medium::Data& medium) {
    constexpr int steps = 65536;  // all stored values of 16 bits, and as fine as single precision needs
    const DeviceVolume::Data& volume = medium.volume.data();
    const double low = volume.stored_min, per_step = std::max((volume.stored_max - low) / steps, 1e-30);
    ExtinctionTable table{{}, float(1 / per_step), float(-low / per_step)};
    for (int j = 0; j <= steps; ++j) {
        const double value = volume.scale * (low + j * per_step) + volume.offset;
        double clear = 1;
        for (const IsoSurface& s : medium.shape.iso) clear *= value >= s.value ? 1 - s.opacity : 1;
        table.per_edge.push_back(float(extinction_of(1 - clear)));
    }
    return table;
}

}  // namespace

ExtinctionTable extinction_table(const Medium::Data& medium, const CellGrid& grid) {
    if (medium.shape.mode == Mode::iso) return inside_surfaces(medium);
    return {extinction_per_edge(medium, grid), float(medium.table.index_scale), float(medium.table.index_offset)};
}

ExtinctionCells::ExtinctionCells(const CellGrid& grid, int stride) : stride_(stride) {
    for (int axis = 0; axis < 3; ++axis) count_[axis] = (grid.count[axis] + stride - 1) / stride * stride;
    phase_ = count_[0] / stride + gap;
    const double row = double(phase_) * stride, all = row * count_[1] * count_[2] + 2 * gap;
    if (all > 2147483647.0)
        throw Error(ErrorCode::output,
                    "rays through the volume would need more than 2147483647 cells: resample the volume, or choose "
                    "another lighting method");
    row_ = int(row), slice_ = row_ * count_[1];
    buffer_ = VoxelBuffer(std::size_t(all) * sizeof(float));
}

ExtinctionCells::ExtinctionCells(const Medium::Data& medium, const CellOpacity& opacity, int stride, Progress& progress)
    : ExtinctionCells(opacity.values.grid, stride) {
    with_stored_voxel(medium.volume.data(), [&](auto voxel) {
        fill(opacity.values.grid, opacity.matter, medium.volume.data().device.threads,
             CellExtinction<decltype(voxel)>(medium, opacity), progress);
    });
}

ExtinctionCells::ExtinctionCells(const Density& density, int stride, const Device& device, Progress& progress)
    : ExtinctionCells(density.grid, stride) {
    const auto extinction = [&](int x, int y, int z) { return density.data()[density.grid.index(x, y, z)]; };
    fill(density.grid, BlockMap(density.grid.count, true), device.threads, extinction, progress);
}

template <class Extinction>
void ExtinctionCells::fill(const CellGrid& grid, const BlockMap& matter, int threads, const Extinction& extinction,
                           Progress& progress) {
    float* cells = reinterpret_cast<float*>(buffer_.data()) + gap;
    std::array<int, 3> low = count_, high{-1, -1, -1};
    std::mutex merging;
    const auto blocks = matter.held();
    const auto work = [&](std::int64_t b, std::int64_t) {
        std::array<int, 3> least = count_, most{-1, -1, -1};
        const auto [x, y, z] = matter.cells(blocks[b], grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                for (int i = x.first; i < x.second; ++i) {
                    const float kappa = extinction(i, j, k);
                    cells[std::int64_t(k) * slice_ + std::int64_t(j) * row_ + place(i)] = kappa;
                    if (!(kappa > 0)) continue;
                    const std::array at{i, j, k};
                    for (int axis = 0; axis < 3; ++axis) {
                        least[axis] = std::min(least[axis], at[axis]);
                        most[axis] = std::max(most[axis], at[axis]);
                    }
                }
        const std::lock_guard lock(merging);
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], least[axis]);
            high[axis] = std::max(high[axis], most[axis]);
        }
    };
    parallel_for(threads, std::int64_t(blocks.size()), 1, "extinction", progress, work);
    progress.check();
    if (high[0] >= 0) low_ = low, high_ = high;
}

}  // namespace chiaro
