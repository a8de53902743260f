// What only a GPU does beside spao/steps.h: a thread for each cell of whole grids, and many blocks at a time, where the
// CPU takes rows of the blocks that hold something through its cache (fused.cpp, coarse.cpp, means.cpp).
#include "illumination/spao/gpu.h"

#include <optional>

#include "illumination/cells/gpu.h"
#include "illumination/spao/coarse.h"
#include "illumination/spao/launch_gpu.h"
#include "illumination/spao/steps.h"

namespace chiaro {
namespace {

using Shorts = cuda::Array<std::uint16_t>;
using Cells = std::array<int, 3>;

kernel::GridTarget target_of(std::uint16_t* to, const Cells& n) { return {to, n[0], n[0] * n[1], {n[0], n[1], n[2]}}; }

/// Opacities there, and what is found out of them.
class GpuAccess {
public:
    GpuAccess(const Device& device, const CellOpacity& opacity, Progress& progress)
        : stream_(*device.stream),
          progress_(progress),
          grid_(opacity.values.grid),
          opacity_(opacity.values.on_gpu(stream_)),
          access_(device, grid_) {}

    cuda::Stream& stream() const { return stream_; }
    const Cells& count() const { return grid_.count; }
    kernel::OpacityGrid opacity() const { return opacity_grid(grid_.count, opacity_); }
    kernel::GridTarget target() const { return target_of(access_.data(), grid_.count); }

    template <class Work>
    void for_blocks(const BlockMap& map, const Work& work) const {
        chiaro::for_blocks(stream_, map, "spao", progress_, work);
    }
    void wait(double share) const {
        stream_.wait();
        progress_.report("spao", share);
        progress_.check();
    }
    CellValues release() { return access_.release(); }

private:
    cuda::Stream& stream_;
    Progress& progress_;
    const CellGrid grid_;
    const std::uint16_t* opacity_;
    GpuCells access_;
};

/// As CoarseGrid, but that the octants of a corner lie side by side.
struct GpuCoarse {
    CoarseShape shape;
    Shorts opacity, open, weight;
    BlockMap needed;

    GpuCoarse(cuda::Stream& stream, const Cells& finer, int octants, const BlockMap& asked)
        : shape(finer),
          opacity(stream, shape.cells_held()),
          open(stream, shape.corners_held() * std::size_t(octants)),
          weight(stream, octants > 1 ? shape.corners_held() : 1),
          needed(shape.needed_by(asked)) {}

    kernel::OpacityGrid cells() const { return opacity_grid(shape.count, opacity.data()); }
    /// Null where a corner has one number.
    kernel::EightOctants* octants() const {
        return weight.size() > 1 ? static_cast<kernel::EightOctants*>(static_cast<void*>(open.data())) : nullptr;
    }
    kernel::CoarseCorners corners() const {
        const auto [nx, ny, nz] = shape.corners;
        return {octants(), open.data(), weight.data(), {nx, ny, nz}};
    }
};

class GpuSweep {
public:
    GpuSweep(GpuAccess& access, const SpaoSettings& settings, bool of_surfaces, const BlockMap& blocks)
        : access_(access),
          settings_(settings),
          of_surfaces_(of_surfaces),
          octants_(octants_of(settings.model)),
          blocks_(blocks) {}

    void make_coarse_grids() {
        for (int g = 1; g <= coarse_grids(settings_); ++g) {
            const GpuCoarse* finer = coarse_.empty() ? nullptr : &coarse_.back();
            GpuCoarse grid(access_.stream(), finer ? finer->shape.count : access_.count(), octants_,
                           finer ? finer->needed : blocks_);
            fill(grid, finer);
            coarse_.push_back(std::move(grid));
        }
        tiles_.emplace(access_.stream(), max_together());
        access_.wait(1);
    }

    void sweep_corners(int g) const {
        const GpuCoarse& grid = coarse_[g - 1];
        kernel::SpaoBatch batch = batch_on(g, grid.cells());
        batch.block.weight = octants_ > 1 ? grid.weight.data() : nullptr;
        batch.octants = grid.octants();
        batch.to = target_of(batch.octants ? nullptr : grid.open.data(), grid.shape.corners);
        access_.for_blocks(grid.needed, [&](const kernel::BlockPlace* places, std::int64_t count) {
            batch.places = places;
            kernel::result_corners(access_.stream(), batch, count);
        });
    }

    CellValues sweep_cells() {
        kernel::SpaoBatch batch = batch_on(0, access_.opacity());
        batch.to = access_.target();
        access_.for_blocks(blocks_, [&](const kernel::BlockPlace* places, std::int64_t count) {
            batch.places = places;
            kernel::result_cells(access_.stream(), batch, count);
        });
        return access_.release();
    }

private:
    /// Blocks that any of the sweeps takes at a time.
    std::size_t max_together() const {
        std::size_t most = blocks_.held().size();
        for (const GpuCoarse& grid : coarse_) most = std::max(most, grid.needed.held().size());
        return std::clamp<std::size_t>(most, 1, blocks_together);
    }

    /// `finer`: none for the first.
    void fill(const GpuCoarse& grid, const GpuCoarse* finer) const {
        cuda::Stream& stream = access_.stream();
        const kernel::OpacityGrid from = finer ? finer->cells() : access_.opacity();
        const kernel::GridTarget cells = target_of(grid.opacity.data(), grid.shape.count);
        if (octants_ == 1) return kernel::fill_grid(stream, kernel::MeanOfEight{from, 0}, cells);
        kernel::fill_grid(stream, kernel::CrossingOfEight{from}, cells);
        const kernel::GridTarget weights = target_of(grid.weight.data(), grid.shape.corners);
        if (!finer) return kernel::fill_grid(stream, kernel::CornerWeights{from}, weights);
        const auto [nx, ny, nz] = finer->shape.corners;
        kernel::fill_grid(stream, kernel::EveryOther{finer->weight.data(), {nx, ny, nz}}, weights);
    }

    kernel::SpaoBatch batch_on(int g, const kernel::OpacityGrid& opacity) const {
        const bool has_coarser = g < int(coarse_.size());
        kernel::SpaoBatch batch{};
        batch.tiles = tiles_->data();
        batch.opacity = opacity;
        batch.block = spao_block(settings_, of_surfaces_, has_coarser);
        if (has_coarser) batch.coarse = coarse_[g].corners();
        return batch;
    }

    GpuAccess& access_;
    const SpaoSettings& settings_;
    const bool of_surfaces_;
    const int octants_;
    const BlockMap& blocks_;
    std::vector<GpuCoarse> coarse_;
    std::optional<cuda::Array<kernel::SpaoTile>> tiles_;
};

/// As SpaoLevels.
class GpuLevels {
public:
    GpuLevels(const GpuAccess& access, const CellGrid& grid, int top) : access_(access), grid_(grid), top_(top) {}

    void copy_opacity() {
        const kernel::GridTarget to = add(LevelShape::of(grid_));
        kernel::fill_grid(access_.stream(), access_.opacity(), within(to));
        wait();
    }
    void add_mipmap() {
        const kernel::MeanOfEight means{back(), 1};
        const kernel::GridTarget to = add(levels_.back().shape.mipmap());
        kernel::fill_grid(access_.stream(), means, within(to));
        wait();
    }
    void add_nbuffer(int distance) {
        const kernel::NextNBuffer next{back(), distance};
        kernel::fill_grid(access_.stream(), next, add(levels_.back().shape.nbuffer(distance)));
        wait();
    }
    kernel::StoredLevels view() const {
        kernel::StoredLevels view{};
        for (std::size_t l = 0; l < levels_.size(); ++l) view.at[l] = levels_[l].shape.view(levels_[l].cells.data());
        return view;
    }

private:
    struct Level {
        LevelShape shape;
        Shorts cells;
    };
    kernel::OpacityGrid back() const { return opacity_grid(levels_.back().shape.count, levels_.back().cells.data()); }
    kernel::GridTarget add(const LevelShape& shape) {
        levels_.push_back({shape, Shorts(access_.stream(), shape.size())});
        levels_.back().cells.zero();
        return target_of(levels_.back().cells.data(), shape.count);
    }
    /// Without the layer of zeros.
    static kernel::GridTarget within(kernel::GridTarget to) {
        to.to += to.slice + to.row + 1;
        for (std::int32_t& n : to.count) n -= 2;
        return to;
    }

    void wait() const { access_.wait(double(levels_.size() - 1) / top_); }

    const GpuAccess& access_;
    const CellGrid& grid_;
    const int top_;  ///< the last level
    std::vector<Level> levels_;
};

template <class Kernel>
CellValues combine(GpuAccess& access, const Kernel& kernel, const BlockMap& blocks) {
    kernel::AccessBatch<Kernel> batch{kernel, nullptr, access.target()};
    access.for_blocks(blocks, [&](const kernel::BlockPlace* places, std::int64_t count) {
        batch.places = places;
        kernel::result_access(access.stream(), batch, count);
    });
    return access.release();
}

}  // namespace

CellValues fused_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                        const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces) {
    GpuAccess access(device, opacity, progress);
    GpuSweep sweep(access, settings, of_surfaces, blocks);
    return fused_steps(sweep, settings, timer);
}

CellValues stored_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings, int mip_levels,
                         const BlockMap& blocks, StageTimer& timer, Progress& progress) {
    GpuAccess access(device, opacity, progress);
    GpuLevels levels(access, opacity.values.grid, settings.levels);
    level_steps(levels, mip_levels, settings.levels, timer);
    return timer("spao combine", [&] { return combine(access, stored_kernel(levels.view(), settings), blocks); });
}

CellValues exact_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                        const BlockMap& blocks, StageTimer& timer, Progress& progress) {
    GpuAccess access(device, opacity, progress);
    const auto& n = access.count();
    cuda::Array<std::int64_t> sums(access.stream(), sums_of(n));
    timer("spao sums", [&] {
        sums.zero();
        kernel::sum_up(access.stream(), {access.opacity(), sums.data()});
        access.wait(0);
    });
    const kernel::OpacitySums view{sums.data(), {n[0], n[1], n[2]}};
    return timer("spao combine", [&] { return combine(access, exact_kernel(view, settings), blocks); });
}

}  // namespace chiaro
