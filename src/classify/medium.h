// What stands behind a Medium.
#pragma once
#include <chiaro/medium.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "classify/occupancy_kernel.h"
#include "core/lazy.h"
#include "kernel/gather.h"
#include "volume/device_volume.h"

namespace chiaro {

/// Colour and extinction over the stored values; entry j stands for the stored value (j - index_offset) / index_scale.
struct OpticalTable {
    struct Entry {
        float r, g, b;            ///< not premultiplied; linear, or display colours as they are
        float extinction_per_mm;  ///< κ
    };
    std::vector<Entry> entries;
    double index_scale = 1, index_offset = 0;
    double unit_mm = 1;  ///< the length that the transfer function's opacities belong to

    double index_of(double stored) const { return stored * index_scale + index_offset; }
    std::size_t nearest(double stored) const {
        return std::size_t(std::clamp(index_of(stored) + 0.5, 0.0, double(entries.size()) - 1));
    }
    const Entry& at(double stored) const { return entries[nearest(stored)]; }
};

struct SegmentTable;

/// The pre-integrated table that was last asked for (classify/segments.h).
struct LastSegments {
    std::mutex mutex;
    double step_mm = 0;
    std::optional<double> albedo_limit;
    std::shared_ptr<const SegmentTable> table;
};

class SurfaceTable;
class ShareTable;

struct Medium::Data : std::enable_shared_from_this<Data> {
    DeviceVolume volume;
    OpticalTable table;
    Shape shape;
    std::vector<std::uint8_t> cells;  ///< as volume/occupancy.h reads them
    double occupied_fraction = 0;
    std::vector<std::shared_ptr<const Data>> channels;  ///< of a mixture: each for itself; else empty
    std::shared_ptr<const VoxelBuffer> share;           ///< of a channel that is of some labels alone; null: everywhere
    std::shared_ptr<const LabelBricks> surface_labels;  ///< of isosurfaces that labels cut and tint; null: none
    std::shared_ptr<const Data> lit_as;                 ///< of a level by bricks: the medium whose light it is seen in
    mutable LastSegments last_segments;
    Lazy<std::shared_ptr<const SurfaceTable>> surface_table;  ///< classify/surface_table.h
    Lazy<std::shared_ptr<const ShareTable>> share_table;      ///< there, too

    std::size_t cell_count() const { return cells.size() - kernel::spare_bytes; }
    /// From `cells`.
    void find_occupied_fraction() {
        const auto occupied = std::count_if(cells.begin(), cells.end(), [](std::uint8_t code) { return code & 1; });
        occupied_fraction = double(occupied) / double(cell_count());
    }
    void add_to(HostArrays& arrays) const {
        volume.data().add_to(arrays);
        arrays.add(weak_from_this(), cells);
    }
};

/// Whether samples are made of several channels, which kernel::VolumeView::matter_at knows; `table` is the first's.
inline bool is_mixed(const Medium::Data& medium) { return medium.volume.data().mixture != nullptr; }

/// Whether it is drawn and lit by the CPU alone.
inline bool is_for_cpu(const Medium::Data& medium) { return is_mixed(medium) || medium.surface_labels; }
inline Device device_for(const Device& device, const Medium::Data& medium) {
    Device its = device;
    if (is_for_cpu(medium)) its.stream = nullptr;
    return its;
}

/// Calls use(channel's medium) for each, or once for one without channels.
template <class Use>
void for_each_channel(const Medium::Data& medium, const Use& use) {
    if (medium.channels.empty()) return use(medium);
    for (const auto& channel : medium.channels) use(*channel);
}

/// Gives back the memory of the bricks in which the medium shows nothing: of many scans, half. They read as stored 0
/// from then on, so the volume is good for this medium alone, and for what looks up values where they are occupied or
/// classified one by one: rays without pre-integration, and the light of none and spao. Nothing is done where stored 0
/// would show, for isosurfaces and for maxima.
void discard_unseen(const Medium& medium);

/// The table of a transfer function over the stored values that occur (classify/table.cpp). About 4096 entries; for
/// whole numbers a power of two per unit, so that every stored value has an entry of its own wherever they fit.
/// A colour's component as the mode composites it.
float composited_color(double c, RgbSpace space, ColorMode mode);
OpticalTable make_optical_table(const DeviceVolume::Data& volume, const TransferFunction& tf, const Shape& shape);

/// Throws Error{usage} unless the shape can be shown.
void validate(const Shape& shape);

/// Whether something may be seen between two stored values.
struct RangeTest {
    std::vector<std::int32_t> before;
    kernel::RangeView view{};  ///< points into `before`

    RangeTest() = default;
    RangeTest(RangeTest&&) = default;
    bool operator()(float low, float high) const { return view(low, high); }
};

/// The code of every cell (volume/occupancy.h), and kernel::spare_bytes at the end.
/// A cell is occupied where `is_visible` says so of its range of stored values, and where `left` (of each cell; empty:
/// all) is not 0. Throws Error{interrupted} when
/// cancelled.
std::vector<std::uint8_t> make_occupancy(const CellRanges& ranges,
                                         const std::function<bool(float low, float high)>& is_visible, int threads,
                                         const Progress& progress = Progress(),
                                         const std::vector<std::uint8_t>& left = {});
/// The same of cells of many kinds, one of which is empty: cubes are of one kind.
std::vector<std::uint8_t> make_occupancy(const std::array<int, 3>& count, std::vector<std::uint32_t> kinds,
                                         std::uint32_t empty, const Progress& progress);
/// Whether the transfer function leaves something visible between two stored values.
RangeTest visible_range(const OpticalTable& table);
/// Whether an isosurface passes between two stored values.
RangeTest crossed_range(const DeviceVolume::Data& volume, const std::vector<IsoSurface>& surfaces);

}  // namespace chiaro
