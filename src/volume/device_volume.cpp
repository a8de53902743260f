// upload: voxels into bricks, with the value range of every cell.
#include "volume/device_volume.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/ranks.h"
#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/fill_brick.h"
#include "volume/placed.h"
#include "volume/spare_memory.h"
#include "volume/validate.h"

namespace chiaro {
namespace {

template <class Source>
double largest_of(const Conversion<Source>& c) {
    return std::max(std::abs(double(c.low)), std::abs(double(c.high)));
}

/// 0 but for numbers that floats cannot hold, or not their squares: these come to 2^40, so that doubles have room for
/// what is 2^42 times as much.
template <class Source>
int exponent_for(const Conversion<Source>& c) {
    const double most = largest_of(c);
    const bool fits = most == 0 || (most > 0x1p-90 && most < 0x1p120);
    return fits ? 0 : std::min(40 - std::ilogb(most), 1020);
}

/// Whether all numbers are so far from 0 that floats would hold little of what tells one from another: pressure in Pa,
/// time in s.
template <class Source>
bool is_far_from_zero(const Conversion<Source>& c) {
    const double range = double(c.high) - double(c.low);
    return range > 0 && largest_of(c) > 256 * range;
}

/// Smallest and largest finite stored value; low > high if there is none.
template <class Source>
Conversion<Source> stored_range(const Volume& volume, int threads, const Progress& progress) {
    const auto voxels = volume.as<Source>();
    Conversion<Source> all{0, std::numeric_limits<Source>::max(), std::numeric_limits<Source>::lowest()};
    std::mutex merging;
    parallel_for(threads, std::int64_t(voxels.size()), 1 << 20, [&](std::int64_t first, std::int64_t last) {
        if (progress.cancelled()) return;
        Source low = std::numeric_limits<Source>::max(), high = std::numeric_limits<Source>::lowest();
        bool is_finite = true;
        for (auto i = first; i < last; ++i) {
            if constexpr (std::is_floating_point_v<Source>)
                if (!std::isfinite(voxels[i])) {
                    is_finite = false;
                    continue;
                }
            low = std::min(low, voxels[i]);
            high = std::max(high, voxels[i]);
        }
        const std::lock_guard lock(merging);
        all.low = std::min(all.low, low);
        all.high = std::max(all.high, high);
        all.all_finite = all.all_finite && is_finite;
    });
    progress.check();
    return all;
}

/// Whose voxels, and how they are gone through.
struct Source {
    const Volume& volume;
    VoxelBuffer* discard;  ///< the volume's own, where its pages may be given back
    const Device& device;
    Progress& progress;
};

/// Of all ranks' voxels.
template <class Source>
Conversion<Source> joined(const Device& device, Conversion<Source> mine) {
    for (const Conversion<Source>& other : gather_values(device, mine)) {
        mine.low = std::min(mine.low, other.low), mine.high = std::max(mine.high, other.high);
        mine.all_finite = mine.all_finite && other.all_finite;
    }
    return mine;
}

/// Of all ranks, by the cells of the bricks that are there.
void find_range(const Device& device, const BrickRange& bricks, DeviceVolume::Data& data) {
    struct Range {
        float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    } range;
    constexpr int per_brick = brick_edge / cell_edge;
    const auto& count = data.cells.count;
    const auto end = [&](std::size_t axis) { return std::min(bricks.end[axis] * per_brick, count[axis]); };
    for (int z = bricks.first[2] * per_brick; z < end(2); ++z)
        for (int y = bricks.first[1] * per_brick; y < end(1); ++y) {
            const std::size_t row = (std::size_t(z) * count[1] + y) * count[0];
            for (int x = bricks.first[0] * per_brick; x < end(0); ++x) {
                range.low = std::min(range.low, data.cells.low[row + x]);
                range.high = std::max(range.high, data.cells.high[row + x]);
            }
        }
    data.stored_min = range.low, data.stored_max = range.high;
    for (const Range& other : gather_values(device, range)) {
        data.stored_min = std::min(data.stored_min, other.low);
        data.stored_max = std::max(data.stored_max, other.high);
    }
}

/// Memory for bricks, of which is zero what fill_bricks does not write. Gathers read up to three voxels behind the last
/// one they need.
template <class Device>
void make_bricks(std::size_t layer_bricks, int layers, DeviceVolume::Data& data) {
    const std::size_t voxels = layer_bricks * layers * brick_voxels, bytes = (voxels + 4) * sizeof(Device);
    if (data.placement) {  // most bricks are others', never written, and with small pages take no memory
        data.bricks = VoxelBuffer(bytes);
        return data.bricks.use_small_pages();
    }
    data.bricks = unspecified_bytes(bytes);
    if (data.bricks.is_borrowed()) std::fill_n(reinterpret_cast<Device*>(data.bricks.data()) + voxels, 4, Device(0));
}

/// Layer by layer, so that the source's pages can be given back behind the work.
template <class Stored, class Device>
void fill_bricks(const Source& source, const Conversion<Stored>& conversion, DeviceVolume::Data& data) {
    const auto& [volume, discard, device, progress] = source;
    const auto [nx, ny, nz] = data.dimensions;
    const std::array<int, 3> bricks{brick_count(nx), brick_count(ny), brick_count(nz)};
    const BrickRange there = bricks_of(data.held, data.dimensions);
    data.cells.count = {cell_count(nx), cell_count(ny), cell_count(nz)};
    data.cells.low.resize(std::size_t(data.cells.count[0]) * data.cells.count[1] * data.cells.count[2]);
    data.cells.high.resize(data.cells.low.size());
    const std::size_t layer_bricks = std::size_t(bricks[0]) * bricks[1];
    make_bricks<Device>(layer_bricks, bricks[2], data);
    Device* out = reinterpret_cast<Device*>(data.bricks.data());
    const BoxedVoxels<Stored> voxels{volume.as<Stored>().data(), data.held};
    // The last layer's other slices are zero: not written to fresh memory, of which they take none with small pages.
    const bool is_fresh = !data.bricks.is_borrowed();
    if (const int last = bricks[2] - 1; slices_read(nz, last) < brick_row)
        data.bricks.use_small_pages(last * layer_bricks * brick_voxels * sizeof(Device));
    const int wide = there.end[0] - there.first[0], high = there.end[1] - there.first[1];
    for (int bz = there.first[2]; bz < there.end[2]; ++bz) {
        parallel_for(
            device.threads, std::int64_t(wide) * high, 1,
            [&, nz = nz, &progress = progress](std::int64_t b, std::int64_t) {
                if (progress.cancelled()) return;
                const std::array<int, 3> at{there.first[0] + int(b % wide), there.first[1] + int(b / wide), bz};
                Device* brick = out + ((std::size_t(bz) * bricks[1] + at[1]) * bricks[0] + at[0]) * brick_voxels;
                const int slices = slices_read(nz, bz);
                fill_brick(voxels, conversion, at, slices, brick);
                if (!is_fresh) std::fill(brick + slices * brick_slice, brick + brick_voxels, Device(0));
                fill_cells(brick, at, brick_row, data.cells);
            });
        progress.check();
        progress.report("upload", double(bz + 1) / bricks[2]);
        const int done_slices = (bz + 1) * brick_edge - brick_before;
        if (discard) discard->discard_before(std::size_t(std::min(done_slices, nz)) * ny * nx * sizeof(Stored));
    }
    find_range(device, there, data);
}

/// Chooses the device type and fills it.
template <class Stored>
void store(const Source& source, DeviceVolume::Data& data) {
    const Volume& volume = source.volume;
    Conversion<Stored> c;
    data.whole_numbers = std::is_integral_v<Stored>;
    if constexpr (std::is_integral_v<Stored> && sizeof(Stored) <= 2) {
        using Device = std::make_unsigned_t<Stored>;
        data.stored = voxel_type_of<Device>();
        c.shift = std::numeric_limits<Stored>::min();
        data.shift = double(c.shift);
        data.offset += data.scale * data.shift;
        return fill_bricks<Stored, Device>(source, c, data);
    } else {
        c = joined(source.device, stored_range<Stored>(volume, source.device.threads, source.progress));
        if (c.low > c.high) throw Error(ErrorCode::input, "no voxel of " + volume.source + " is a finite number");
        const auto shift_to_low = [&] {
            c.shift = c.low;
            data.shift = double(c.low);
            data.offset += data.scale * data.shift;
        };
        if constexpr (std::is_integral_v<Stored>)
            if (std::make_unsigned_t<Stored>(c.high) - std::make_unsigned_t<Stored>(c.low) <= 65535u) {
                data.stored = VoxelType::u16;
                data.exact = largest_of(c) <= 0x1p53;
                shift_to_low();
                return fill_bricks<Stored, std::uint16_t>(source, c, data);
            }
        data.stored = VoxelType::f32;
        if constexpr (std::is_floating_point_v<Stored>) c.exponent = exponent_for(c);
        const bool is_shifted = c.exponent == 0 && is_far_from_zero(c);
        const double largest = is_shifted ? double(c.high) - double(c.low) : largest_of(c);
        data.exact = std::is_same_v<Stored, float>
                         ? c.all_finite && c.exponent == 0
                         : largest <= 0x1p24 && largest_of(c) <= 0x1p53 && std::is_integral_v<Stored>;
        data.scale = std::ldexp(data.scale, -c.exponent);
        if (is_shifted) shift_to_low();
        fill_bricks<Stored, float>(source, c, data);
    }
}

/// Volumes may come from a program that made them, not from a file that was checked.
void check_header_of(const Volume& volume) {
    try {
        if (volume.placement && volume.voxel_count() == 0) return;
        if (check_header(volume) > volume.voxels.size())
            throw Error(ErrorCode::input, "has fewer voxels than it states");
    } catch (const Error& error) {
        throw Error(error.code(),
                    fmt::format("{} {}", volume.source.empty() ? "the volume" : volume.source, error.what()));
    }
}

/// What all ranks' blocks have in common; who has no voxels learns it.
struct Common {
    bool known = false;
    std::array<int, 3> whole{0, 0, 0};
    VoxelType type = VoxelType::u8;
    double slope = 1, intercept = 0;
    Geometry geometry;

    explicit Common(const Volume& volume)
        : known(volume.voxel_count() > 0),
          whole(volume.placement ? volume.placement->whole : volume.dimensions),
          type(volume.type),
          slope(volume.slope),
          intercept(volume.intercept),
          geometry(volume.geometry) {}
    Common() = default;
    bool operator==(const Common&) const = default;
};

Common agreed(const Device& device, const Volume& volume) {
    Common common;
    for (const Common& other : gather_values(device, Common(volume))) {
        if (!other.known) continue;
        if (common.known && !(common == other))
            throw Error(ErrorCode::input,
                        "the ranks' blocks are not of one volume: their dimensions of the whole, type, "
                        "geometry, slope or intercept differ");
        common = other;
    }
    if (!common.known) throw Error(ErrorCode::input, "no rank has voxels");
    return common;
}

VoxelBox checked_box(const Device& device, const Volume& volume) {
    if (!volume.placement) {
        if (device.is_shared())
            throw Error(ErrorCode::usage, "each of several ranks shows a block of a volume: it needs a placement");
        return {{0, 0, 0}, volume.dimensions};
    }
    const Placement& place = *volume.placement;
    for (std::size_t a = 0; a < 3 && volume.voxel_count() > 0; ++a) {
        const int end = place.first[a] + volume.dimensions[a];
        if (place.first[a] < 0 || end > place.whole[a] || place.own_first[a] < place.first[a] || place.own_end[a] > end)
            throw Error(
                ErrorCode::usage,
                fmt::format("along axis {} a block of the voxels {} to {}, which owns {} to {}, "
                            "does not lie in a whole of {}",
                            a, place.first[a], end - 1, place.own_first[a], place.own_end[a] - 1, place.whole[a]));
    }
    return {place.first, volume.dimensions};
}

void upload_block(const Source& source, DeviceVolume::Data& data) {
    const auto& [volume, discard, device, progress] = source;
    if (volume.components != 1)
        throw Error(ErrorCode::input, volume.source + " has " + std::to_string(volume.components) +
                                          " values a voxel: only volumes of one value a voxel can be rendered");
    if (device.is_shared() && device.has_gpu())
        throw Error(ErrorCode::usage, "several ranks find light on CPUs: no GPU can be used");
    check_header_of(volume);
    data.held = checked_box(device, volume);
    data.placement = volume.placement;
    const Common common = agreed(device, volume);
    data.device = device;
    data.dimensions = common.whole;
    if (data.placement) data.placement->whole = common.whole;
    data.geometry = common.geometry;
    data.scale = common.slope;
    data.offset = data.intercept = common.intercept;
    const auto [nx, ny, nz] = data.dimensions;
    const double stored = double(brick_count(nx)) * brick_count(ny) * brick_count(nz) * brick_voxels;
    if (stored > double(UINT32_MAX) - 8)
        throw Error(ErrorCode::input,
                    fmt::format("{} has {:.0f} voxels: at most about 3.2e9 (1480 cubed) can be rendered", volume.source,
                                double(nx) * ny * nz));
    with_voxel_type(common.type, [&](auto voxel) { store<decltype(voxel)>(source, data); });
    check_values(volume, data.scale * data.stored_min + data.offset, data.scale * data.stored_max + data.offset);
}

DeviceVolume upload_bricks(const Device& device, const Volume& volume, VoxelBuffer* discard, Progress& progress) {
    auto data = std::make_shared<DeviceVolume::Data>();
    const Source source{volume, volume.placement ? nullptr : discard, device, progress};
    collectively(device, [&] { upload_block(source, *data); });
    return DeviceVolume(std::move(data));
}

}  // namespace

DeviceVolume upload(const Device& device, const Volume& volume, Progress& progress) {
    return upload_bricks(device, volume, nullptr, progress);
}
DeviceVolume upload(const Device& device, Volume&& volume, Progress& progress) {
    Volume owned = std::move(volume);
    return upload_bricks(device, owned, &owned.voxels, progress);
}
DeviceVolume upload(const Device& device, const Volume& volume) {
    Progress none;
    return upload(device, volume, none);
}
DeviceVolume upload(const Device& device, Volume&& volume) {
    Progress none;
    return upload(device, std::move(volume), none);
}

std::array<int, 3> DeviceVolume::dimensions() const { return data().dimensions; }
const Geometry& DeviceVolume::geometry() const { return data().geometry; }
bool DeviceVolume::is_exact() const { return data().exact; }
std::size_t DeviceVolume::bytes() const {
    return data().bricks.size() + data().coefficients.size() + data().cells.low.size() * 2 * sizeof(float);
}

}  // namespace chiaro
