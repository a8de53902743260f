// upload: voxels into bricks, with the value range of every cell.
#include "volume/device_volume.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/fill_brick.h"
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
    int threads;
    Progress& progress;
};

/// Layer by layer, so that the source's pages can be given back behind the work.
template <class Stored, class Device>
void fill_bricks(const Source& source, const Conversion<Stored>& conversion, DeviceVolume::Data& data) {
    const auto& [volume, discard, threads, progress] = source;
    const auto [nx, ny, nz] = volume.dimensions;
    const std::array<int, 3> bricks{brick_count(nx), brick_count(ny), brick_count(nz)};
    data.cells.count = {cell_count(nx), cell_count(ny), cell_count(nz)};
    data.cells.low.resize(std::size_t(data.cells.count[0]) * data.cells.count[1] * data.cells.count[2]);
    data.cells.high.resize(data.cells.low.size());
    const std::size_t layer_bricks = std::size_t(bricks[0]) * bricks[1];
    // Gathers read up to three voxels behind the last one they need.
    data.bricks = VoxelBuffer((layer_bricks * bricks[2] * brick_voxels + 4) * sizeof(Device));
    Device* out = reinterpret_cast<Device*>(data.bricks.data());
    const BoxedVoxels<Stored> voxels{volume.as<Stored>().data(), {{0, 0, 0}, volume.dimensions}, volume.dimensions};
    // The last layer's other slices are never written, and with small pages take no memory.
    if (const std::size_t last = (bricks[2] - 1) * layer_bricks * brick_voxels;
        slices_read(nz, bricks[2] - 1) < brick_row)
        data.bricks.use_small_pages(last * sizeof(Device));
    for (int bz = 0; bz < bricks[2]; ++bz) {
        parallel_for(threads, std::int64_t(layer_bricks), 1,
                     [&, &volume = volume, &progress = progress](std::int64_t b, std::int64_t) {
                         if (progress.cancelled()) return;
                         const std::array<int, 3> at{int(b % bricks[0]), int(b / bricks[0]), bz};
                         Device* brick = out + (bz * layer_bricks + std::size_t(b)) * brick_voxels;
                         fill_brick(voxels, conversion, at, slices_read(volume.dimensions[2], bz), brick);
                         fill_cells(brick, at, brick_row, data.cells);
                     });
        progress.check();
        progress.report("upload", double(bz + 1) / bricks[2]);
        const int done_slices = (bz + 1) * brick_edge - brick_before;
        if (discard) discard->discard_before(std::size_t(std::min(done_slices, nz)) * ny * nx * sizeof(Stored));
    }
    data.stored_min = *std::min_element(data.cells.low.begin(), data.cells.low.end());
    data.stored_max = *std::max_element(data.cells.high.begin(), data.cells.high.end());
}

/// Chooses the device type and fills it.
template <class Stored>
void store(const Source& source, DeviceVolume::Data& data) {
    const Volume& volume = source.volume;
    Conversion<Stored> c;
    data.scale = volume.slope;
    data.offset = data.intercept = volume.intercept;
    data.whole_numbers = std::is_integral_v<Stored>;
    if constexpr (std::is_integral_v<Stored> && sizeof(Stored) <= 2) {
        using Device = std::make_unsigned_t<Stored>;
        data.stored = voxel_type_of<Device>();
        c.shift = std::numeric_limits<Stored>::min();
        data.shift = double(c.shift);
        data.offset += volume.slope * data.shift;
        return fill_bricks<Stored, Device>(source, c, data);
    } else {
        c = stored_range<Stored>(volume, source.threads, source.progress);
        if (c.low > c.high) throw Error(ErrorCode::input, "no voxel of " + volume.source + " is a finite number");
        if constexpr (std::is_integral_v<Stored>)
            if (std::make_unsigned_t<Stored>(c.high) - std::make_unsigned_t<Stored>(c.low) <= 65535u) {
                data.stored = VoxelType::u16;
                c.shift = c.low;
                data.shift = double(c.low);
                data.offset += volume.slope * data.shift;
                return fill_bricks<Stored, std::uint16_t>(source, c, data);
            }
        data.stored = VoxelType::f32;
        data.exact =
            std::is_same_v<Stored, float> ? c.all_finite : largest_of(c) <= 0x1p24 && std::is_integral_v<Stored>;
        if constexpr (std::is_floating_point_v<Stored>) {
            c.exponent = exponent_for(c);
            data.scale = std::ldexp(volume.slope, -c.exponent);
            data.exact = data.exact && c.exponent == 0;
        }
        fill_bricks<Stored, float>(source, c, data);
    }
}

/// Volumes may come from a program that made them, not from a file that was checked.
void check_header_of(const Volume& volume) {
    try {
        if (check_header(volume) > volume.voxels.size())
            throw Error(ErrorCode::input, "has fewer voxels than it states");
    } catch (const Error& error) {
        throw Error(error.code(),
                    fmt::format("{} {}", volume.source.empty() ? "the volume" : volume.source, error.what()));
    }
}

DeviceVolume upload_bricks(const Device& device, const Volume& volume, VoxelBuffer* discard, Progress& progress) {
    if (volume.components != 1)
        throw Error(ErrorCode::input, volume.source + " has " + std::to_string(volume.components) +
                                          " values a voxel: only volumes of one value a voxel can be rendered");
    check_header_of(volume);
    const auto [nx, ny, nz] = volume.dimensions;
    const double stored = double(brick_count(nx)) * brick_count(ny) * brick_count(nz) * brick_voxels;
    if (stored > double(UINT32_MAX) - 8)
        throw Error(ErrorCode::input, volume.source + " has " + std::to_string(volume.voxel_count()) +
                                          " voxels: at most about 3.2e9 (1480 cubed) can be rendered");
    auto data = std::make_shared<DeviceVolume::Data>();
    data->device = device;
    data->dimensions = volume.dimensions;
    data->geometry = volume.geometry;
    const Source source{volume, discard, device.threads, progress};
    with_voxel_type(volume.type, [&](auto voxel) { store<decltype(voxel)>(source, *data); });
    check_values(volume, data->scale * data->stored_min + data->offset, data->scale * data->stored_max + data->offset);
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
