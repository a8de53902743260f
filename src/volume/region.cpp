#include <chiaro/error.h>
#include <chiaro/measuring.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/threads.h"
#include "volume/part.h"
#include "volume/reader.h"

namespace chiaro {
namespace {

/// A region in voxels: which are looked at, and which of them are in it.
struct VoxelRegion {
    Vec3 low, high;  ///< box of what is looked at
    std::optional<BallRegion> ball;
    double exact_mm3 = 0;
};

double voxel_mm3(const Geometry& g) {
    return g.spacing_mm.x * g.spacing_mm.y * g.spacing_mm.z *
           std::abs(dot(g.direction[0], cross(g.direction[1], g.direction[2])));
}

VoxelRegion in_voxels(const Geometry& geometry, const BallRegion& ball) {
    if (!(ball.radius_mm > 0)) throw Error(ErrorCode::usage, "region: the ball's radius must be above 0");
    const Vec3 centre = geometry.voxel_from_world(ball.centre_mm);
    VoxelRegion region{centre, centre, ball, 4.0 / 3 * radians(180) * std::pow(ball.radius_mm, 3)};
    // How far a ball reaches along an oblique index axis: the length of that row of the inverse.
    for (int axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (const Vec3 unit : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
            sum += std::pow(geometry.voxel_from_world_vector(unit)[axis], 2);
        region.low[axis] -= ball.radius_mm * std::sqrt(sum), region.high[axis] += ball.radius_mm * std::sqrt(sum);
    }
    return region;
}

VoxelRegion in_voxels(const Geometry& geometry, const BoxRegion& box) {
    const Vec3 a = geometry.voxel_from_world(box.corner_mm), b = geometry.voxel_from_world(box.opposite_mm);
    VoxelRegion region;
    region.exact_mm3 = voxel_mm3(geometry);
    for (int axis = 0; axis < 3; ++axis) {
        region.low[axis] = std::min(a[axis], b[axis]), region.high[axis] = std::max(a[axis], b[axis]);
        region.exact_mm3 *= region.high[axis] - region.low[axis];
    }
    return region;
}

/// What rounding may have taken from a voxel that lies on the rim.
constexpr double rim = 1e-9;

std::vector<double> values_in(const DeviceVolume::Data& volume, const VoxelRegion& region, Progress& progress) {
    std::array<int, 3> first{}, last{};
    for (int axis = 0; axis < 3; ++axis) {
        const double n = volume.dimensions[axis];
        first[axis] = int(std::ceil(std::clamp(region.low[axis] - rim, 0.0, n)));
        last[axis] = int(std::floor(std::clamp(region.high[axis] + rim, -1.0, n - 1)));
        if (first[axis] > last[axis]) return {};
    }
    const auto is_in = [&](Vec3 p) {
        if (!region.ball) return true;
        const Vec3 from = volume.geometry.world_from_voxel(p) - region.ball->centre_mm;
        return length(from) <= region.ball->radius_mm * (1 + rim);
    };
    std::vector<std::vector<double>> of_slice(std::size_t(last[2] - first[2] + 1));
    with_stored_voxel(volume, [&](auto voxel) {
        const Reader<decltype(voxel)> reader{volume};
        const auto gather = [&](std::int64_t begin, std::int64_t end) {
            for (auto z = begin; z < end; ++z)
                for (int y = first[1]; y <= last[1]; ++y)
                    for (int x = first[0]; x <= last[0]; ++x)
                        if (const Vec3 p{double(x), double(y), double(first[2] + z)}; is_in(p))
                            of_slice[std::size_t(z)].push_back(reader.nearest(p));
        };
        parallel_for(volume.device.threads, std::int64_t(of_slice.size()), 1, "measure", progress, gather);
    });
    progress.check();
    std::vector<double> values;
    for (const auto& slice : of_slice) values.insert(values.end(), slice.begin(), slice.end());
    return values;
}

/// numpy's "linear": the value at position share · (n - 1) of the sorted ones.
double percentile(std::vector<double>& values, double share) {
    const double position = share * double(values.size() - 1);
    const auto at = values.begin() + std::ptrdiff_t(position);
    std::nth_element(values.begin(), at, values.end());
    const double t = position - std::floor(position);
    return t == 0 ? *at : *at + t * (*std::min_element(at + 1, values.end()) - *at);
}

void summarize(std::vector<double>& values, RegionValues& told) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    told.min = *low, told.max = *high;
    long double sum = 0, squares = 0;
    for (const double v : values) sum += v;
    const long double mean = sum / (long double)(values.size());
    const double bins = double(told.histogram.size()),
                 per_value = told.max > told.min ? bins / (told.max - told.min) : 0;
    for (const double v : values) {
        squares += (v - mean) * (v - mean);
        ++told.histogram[std::size_t(std::min((v - told.min) * per_value, bins - 1))];
    }
    told.mean = double(mean);
    if (values.size() > 1) told.deviation = double(std::sqrt(squares / (long double)(values.size() - 1)));
    for (std::size_t i = 0; i < told.shares.size(); ++i) told.percentiles[i] = percentile(values, told.shares[i]);
}

}  // namespace

namespace {

VoxelRegion in_voxels(const Geometry& geometry, const Region& region) {
    const VoxelRegion own = std::visit([&](const auto& shape) { return in_voxels(geometry, shape); }, region);
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(own.low[axis]) || !std::isfinite(own.high[axis]))
            throw Error(ErrorCode::usage, "region: must be of finite numbers");
    return own;
}

[[noreturn]] void refuse_empty() { throw Error(ErrorCode::usage, "region: no voxel's centre lies in it"); }

}  // namespace

RegionValues measure(const DeviceVolume& volume, const Region& region, Progress& progress) {
    const DeviceVolume::Data& data = volume.data();
    const VoxelRegion own = in_voxels(data.geometry, region);
    std::vector<double> values = values_in(data, own, progress);
    if (values.empty()) refuse_empty();
    RegionValues told;
    told.count = values.size();
    told.volume_mm3 = double(values.size()) * voxel_mm3(data.geometry);
    told.exact_mm3 = own.exact_mm3;
    summarize(values, told);
    return told;
}

RegionValues measure(const BrickSource& source, const DeviceVolume& whole, const Region& region, Progress& progress) {
    const SourceLevel& finest = source.levels().front();
    const VoxelRegion own = in_voxels(finest.geometry, region);
    const VoxelBox box = box_around(finest, own.low, own.high);
    if (voxels_in(box) == 0) refuse_empty();
    return measure(part_of(source, 0, box, whole), region, progress);
}

}  // namespace chiaro
