// The coefficients of B-splines, and voxels as B-splines smooth them.
#include "volume/splined.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include "core/threads.h"
#include "volume/filtered_bricks.h"
#include "volume/spline_cells.h"

namespace chiaro {
namespace {

/// Smallest and largest of all coefficients.
std::pair<float, float> range_of(FilteredBricks& coefficients, Isa isa, const Progress& progress) {
    std::pair range(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
    std::mutex merging;
    const auto find_range = kernel::spline_functions_for(isa).find_range;
    coefficients.for_each(progress, [&](const float* values, const std::array<int, 3>&) {
        float low, high;
        find_range(values, brick_voxels, low, high);
        const std::lock_guard lock(merging);
        range = {std::min(range.first, low), std::max(range.second, high)};
    });
    return range;
}

/// How coefficients are stored: as wide as the voxels, over the range that occurs; the least voxel value, which often
/// is the empty one, exactly.
template <class Voxel>
SplineCoding coding_for(const DeviceVolume::Data& source, FilteredBricks& coefficients, const Progress& progress) {
    if constexpr (std::is_floating_point_v<Voxel>) return {};
    constexpr float codes = std::numeric_limits<Voxel>::max();
    const auto [low, high] = range_of(coefficients, source.device.isa, progress);
    SplineCoding coding;
    coding.scale = high > low ? (high - low) / (codes - 1) : 1;
    coding.least = source.stored_min;
    coding.base = std::round((source.stored_min - low) / coding.scale);
    return coding;
}

/// The codes of a brick, border included, whose coefficients would lie beyond the bounds.
template <class Voxel>
void keep_within(const CoefficientBounds& bounds, const SplineCoding& coding, const std::array<int, 3>& n,
                 const std::array<int, 3>& brick, int slices, Voxel* codes) {
    const auto code_of = [&](float stored) { return (stored - coding.least) / coding.scale + coding.base; };
    float low = code_of(bounds.low), high = code_of(bounds.high);
    if constexpr (!std::is_floating_point_v<Voxel>) {
        constexpr float most = std::numeric_limits<Voxel>::max();
        low = std::clamp(std::ceil(low), 0.f, most), high = std::clamp(std::floor(high), 0.f, most);
        if (low > high) return;  // no code lies between the bounds
    }
    for_each_of_brick(n, brick, slices, codes, [&](Voxel& code, std::size_t voxel) {
        if (bounds.is_bounded[voxel]) code = std::clamp(code, Voxel(low), Voxel(high));
    });
}

/// The bricks of the filtered voxels, as those of `source` lie.
template <class Voxel>
VoxelBuffer coded_bricks(const DeviceVolume::Data& source, FilteredBricks& filtered, const SplineCoding& coding,
                         const Progress& progress) {
    VoxelBuffer bricks(source.bricks.size());
    const auto [nx, ny, nz] = source.dimensions;
    const std::size_t bricks_x = std::size_t(brick_count(nx)), bricks_y = std::size_t(brick_count(ny));
    const int layers = brick_count(nz);
    if (slices_read(nz, layers - 1) < brick_row)
        bricks.use_small_pages(std::size_t(layers - 1) * bricks_x * bricks_y * brick_voxels * sizeof(Voxel));
    auto* out = reinterpret_cast<Voxel*>(bricks.data());
    const kernel::CodeFunctions<Voxel> run = kernel::spline_functions_for(source.device.isa);
    filtered.for_each(progress, [&](const float* values, const std::array<int, 3>& at) {
        const std::size_t brick = (std::size_t(at[2]) * bricks_y + std::size_t(at[1])) * bricks_x + std::size_t(at[0]);
        const int slices = slices_read(source.dimensions[2], at[2]);
        Voxel* codes = out + brick * brick_voxels;
        run.to_codes(values, slices * brick_slice, {coding.base, coding.scale, coding.least}, codes);
        if (source.bounds) keep_within(*source.bounds, coding, source.dimensions, at, slices, codes);
    });
    return bricks;
}

template <class Voxel>
void fill(const DeviceVolume::Data& source, bool interpolates, const Progress& progress, DeviceVolume::Data& made) {
    const auto borrowed = [&] { return VoxelBuffer::borrow(source.bricks.data(), source.bricks.size(), nullptr); };
    FilteredBricks filtered(source, interpolates ? Filter::coefficients : Filter::smoothed);
    if (interpolates) {
        made.spline = coding_for<Voxel>(source, filtered, progress);
        made.coefficients = coded_bricks<Voxel>(source, filtered, made.spline, progress);
        made.bricks = borrowed();
    } else {
        made.bricks = coded_bricks<Voxel>(source, filtered, {}, progress);
        made.coefficients = borrowed();
    }
    find_cells<Voxel>(made);
}

}  // namespace

namespace {

/// How far from a sample the points lie of which its normal is the mean, per axis in voxels. Where slices lie so much
/// farther apart than voxels that normals show them, half a slice's thickness: on balls with edges of .4 and .8 voxel
/// in slices 2 and 4 voxels apart this shows half of them. Farther than three voxels would leave nothing to see. Of
/// smoothed voxels one voxel: so a segmented brain's surface hardly shows the faces of its mask's voxels; with one and
/// a half, sample:tubes has dark outlines; with three, the brain's sulci turn inside out.
std::array<float, 3> normal_reach(const Geometry& geometry, bool interpolates) {
    constexpr double thick = 1.5, farthest = 3;
    const Vec3& spacing = geometry.spacing_mm;
    const double least = geometry.smallest_spacing_mm(), most = std::max({spacing.x, spacing.y, spacing.z});
    if (most < thick * least) return interpolates ? std::array{0.f, 0.f, 0.f} : std::array{1.f, 1.f, 1.f};
    std::array<float, 3> reach;
    for (int axis = 0; axis < 3; ++axis)
        reach[std::size_t(axis)] = float(std::min(0.5 * most / spacing[axis], farthest));
    return reach;
}

}  // namespace

DeviceVolume splined(const DeviceVolume& volume, bool interpolates, const Progress& progress) {
    const auto source = volume.data().shared_from_this();
    DeviceVolume::Splines& splines = source->splines;
    const std::lock_guard lock(splines.mutex);
    auto& kept = interpolates ? splines.interpolating : splines.smoothing;
    if (!kept) {
        auto made = std::make_shared<DeviceVolume::Data>();
        made->describe_as(*source);
        made->cells = source->cells;
        made->stored_min = source->stored_min, made->stored_max = source->stored_max;
        made->normal_reach = normal_reach(source->geometry, interpolates);
        made->source = source.get();
        with_stored_voxel(*source, [&](auto zero) { fill<decltype(zero)>(*source, interpolates, progress, *made); });
        kept = made;
    }
    return DeviceVolume({source, kept.get()});
}

}  // namespace chiaro
