#include "illumination/cells/opacity.h"

#include "classify/clip.h"
#include "classify/medium.h"
#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

using Point = kernel::Vec3<float>;

/// Fills rows of cells from a volume of one stored type.
template <class Voxel>
class CellClassifier {
public:
    CellClassifier(const Medium::Data& medium, CellValues& out)
        : medium_(medium),
          volume_(medium.volume.data()),
          out_(out),
          view_(view_of<Voxel>(volume_)),
          kept_(half_spaces(medium.shape.clip, volume_.geometry, volume_.dimensions)),
          is_iso_(medium.shape.mode == Mode::iso) {
        is_iso_ ? list_surfaces() : tabulate();
    }

    /// Cells [x0, x1) of a row.
    void fill(int x0, int x1, int y, int z, bool near_surface) {
        std::uint16_t* row = out_.data() + out_.grid.index(0, y, z);
        if (is_iso_)
            for (int x = x0; x < x1; ++x) row[x] = coverage(centre(x, y, z), near_surface);
        else if (out_.grid.is_voxel_grid)
            copy_row(x0, x1, y, z, row);
        else
            for (int x = x0; x < x1; ++x) row[x] = opacity_of(value_at(centre(x, y, z)));
        if (!kept_.empty()) clip_row(x0, x1, y, z, row);
    }

private:
    Point centre(int x, int y, int z) const {
        const Vec3 p = out_.grid.voxel_of(x, y, z);
        return view_.clamp(Point(float(p.x), float(p.y), float(p.z)));
    }
    kernel::Location<float> locate(Point p) const { return view_.locate(p, view_.voxel(p)); }
    float value_at(Point p) const { return view_.value(locate(p)); }

    void tabulate() {
        for (float kappa : extinction_per_edge(medium_, out_.grid)) entries_.push_back(cell_value(-std::expm1(-kappa)));
        scale_ = float(medium_.table.index_scale), offset_ = float(medium_.table.index_offset + 0.5);
        if constexpr (sizeof(Voxel) <= 2)
            for (std::size_t v = 0; v < std::size_t(1) << (8 * sizeof(Voxel)); ++v)
                of_stored_.push_back(opacity_of(float(v)));
    }
    std::uint16_t opacity_of(float stored) const {
        const float index = kernel::mad(stored, scale_, offset_);
        return entries_[std::size_t(std::clamp(index, 0.0f, float(entries_.size() - 1)))];
    }

    /// Straight through the bricks: voxel i lies in the brick of interval min(i, n - 2).
    void copy_row(int x0, int x1, int y, int z, std::uint16_t* row) const {
        while (x0 < x1) {
            const Point p{float(x0), float(y), float(z)};
            const auto voxel = view_.voxel(p);
            const auto at = view_.locate(p, voxel);
            // The last voxel of an axis lies behind its last interval.
            const Voxel* from = view_.voxels + std::uint32_t(at.index) + (x0 - voxel.x) + (y - voxel.y) * brick_row +
                                (z - voxel.z) * brick_slice;
            const int in_brick = voxel.x == view_.last_x ? x1 - x0 : brick_edge - (voxel.x & (brick_edge - 1));
            const int count = std::min(x1 - x0, in_brick);
            for (int i = 0; i < count; ++i)
                if constexpr (sizeof(Voxel) <= 2)
                    row[x0 + i] = of_stored_[from[i]];
                else
                    row[x0 + i] = opacity_of(from[i]);
            x0 += count;
        }
    }

    void clip_row(int x0, int x1, int y, int z, std::uint16_t* row) const {
        for (int x = x0; x < x1; ++x)
            for (const HalfSpace& half : kept_)
                if (dot(half.normal, out_.grid.voxel_of(x, y, z)) > half.d) row[x] = 0;
    }

    void list_surfaces() {
        for (const IsoSurface& s : medium_.shape.iso)
            surfaces_.push_back({float((s.value - volume_.offset) / volume_.scale), float(s.opacity)});
        for (int axis = 0; axis < 3; ++axis) per_edge_[axis] = float(out_.grid.voxels_per_cell[axis]);
    }
    std::uint16_t coverage(Point p, bool near_surface) const {
        const auto at = locate(p);
        const float value = view_.value(at), sign = volume_.scale < 0 ? -1.0f : 1.0f;
        float slope = 0;
        if (near_surface) {
            const Point g = view_.gradient(at);
            const Point per_edge{g.x * per_edge_[0], g.y * per_edge_[1], g.z * per_edge_[2]};
            slope = std::sqrt(kernel::dot(per_edge, per_edge));
        }
        float clear = 1;
        for (const auto& [iso, opacity] : surfaces_) {
            const float above = sign * (value - iso);
            const float inside = slope > 0 ? std::clamp(0.5f + above / slope, 0.0f, 1.0f) : float(above >= 0);
            clear *= 1 - opacity * inside;
        }
        return cell_value(1 - clear);
    }

    const Medium::Data& medium_;
    const DeviceVolume::Data& volume_;
    CellValues& out_;
    const kernel::VolumeView<Voxel> view_;
    const std::vector<HalfSpace> kept_;
    const bool is_iso_;
    std::vector<std::uint16_t> entries_, of_stored_;  ///< opacities by table entry, and by stored value
    float scale_ = 1, offset_ = 0;
    std::vector<std::pair<float, float>> surfaces_;  ///< stored value, opacity
    std::array<float, 3> per_edge_{1, 1, 1};
};

template <class Voxel>
void classify_cells(const Medium::Data& medium, CellOpacity& out, Progress& progress) {
    CellClassifier<Voxel> classifier(medium, out.values);
    out.visible = visible_blocks(medium, out.values.grid, 1);
    // Nothing is seen inside a surface, but it is matter.
    if (medium.shape.mode != Mode::iso) out.matter = out.visible;
    const auto blocks = out.matter.held();
    parallel_for(medium.volume.data().device.threads, std::int64_t(blocks.size()), 1, "opacity", progress,
                 [&](std::int64_t b, std::int64_t) {
                     const auto [x, y, z] = out.matter.cells(blocks[b], out.values.grid.count);
                     for (int k = z.first; k < z.second; ++k)
                         for (int j = y.first; j < y.second; ++j)
                             classifier.fill(x.first, x.second, j, k, out.visible.holds[blocks[b]]);
                 });
    progress.check();
}

}  // namespace

std::vector<float> extinction_per_edge(const Medium::Data& medium, const CellGrid& grid) {
    std::vector<float> kappa;
    for (const OpticalTable::Entry& entry : medium.table.entries)
        kappa.push_back(float(entry.extinction_per_mm * grid.edge_mm));
    return kappa;
}

CellOpacity cell_opacity(const Medium::Data& medium, Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const CellGrid grid = make_cell_grid(volume.dimensions, volume.geometry);
    CellOpacity out{CellValues(grid), BlockMap(grid.count, true)};
    with_stored_voxel(volume, [&](auto voxel) { classify_cells<decltype(voxel)>(medium, out, progress); });
    return out;
}

}  // namespace chiaro
