#include <chiaro/error.h>
#include <chiaro/measuring.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "volume/part.h"
#include "volume/reader.h"

namespace chiaro {
namespace {

constexpr double least_edge = 0.02;  ///< of the volume's range, a voxel
constexpr double max_voxels = 12;    ///< on either side of a place, per axis
constexpr double line_half = 6;      ///< voxels on either side that an edge is followed
constexpr double line_step = 0.05;   ///< voxels
constexpr double flat = 0.1;         ///< of the steepest slope: there the matter beside an edge begins

/// The volume around a place, within a plane or not. Lengths are in units of the smallest voxel size.
template <class Voxel>
class Edges {
public:
    Edges(const DeviceVolume::Data& volume, std::optional<Vec3> normal)
        : reader_{volume}, geometry_(volume.geometry), unit_mm_(geometry_.smallest_spacing_mm()), normal_(normal) {
        if (normal_) normal_ = normalized(*normal_);
        least_ = least_edge * std::abs(volume.scale) * double(volume.stored_max - volume.stored_min);
    }

    double value(Vec3 p_mm) const { return reader_.linear(geometry_.voxel_from_world(p_mm)); }

    /// Central differences over a voxel on either side, a voxel.
    Vec3 gradient(Vec3 p_mm) const {
        Vec3 g;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 h;
            h[axis] = unit_mm_;
            g[axis] = 0.5 * (value(p_mm + h) - value(p_mm - h));
        }
        return normal_ ? g - dot(g, *normal_) * *normal_ : g;
    }

    /// The mean of the gradients around a place: on edges as sharp as a voxel one alone is some degrees off.
    Vec3 normal_at(Vec3 p_mm) const {
        Vec3 sum;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    sum = sum + gradient(p_mm + unit_mm_ * Vec3{double(i), double(j), double(k)});
        return length(sum) > 0 ? normalized(sum) : Vec3{};
    }

    /// Of the places around p that are half as steep as the steepest, the nearest.
    std::optional<Vec3> nearest_edge(Vec3 p_mm, double reach_mm) const {
        const int reach = int(std::ceil(std::min(reach_mm / unit_mm_, max_voxels)));
        std::vector<std::pair<double, Vec3>> seen;  // steepness, place
        double steepest = least_;
        for (int k = -reach; k <= reach; ++k)
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i) {
                    const Vec3 away = unit_mm_ * Vec3{double(i), double(j), double(k)};
                    const double off = normal_ ? std::abs(dot(away, *normal_)) : 0;
                    if (length(away) > reach_mm + unit_mm_ || off > 0.87 * unit_mm_) continue;
                    const Vec3 at = normal_ ? p_mm + away - dot(away, *normal_) * *normal_ : p_mm + away;
                    seen.emplace_back(length(gradient(at)), at);
                    steepest = std::max(steepest, seen.back().first);
                }
        std::optional<Vec3> nearest;
        for (const auto& [steepness, at] : seen)
            if (steepness >= std::max(0.5 * steepest, least_) &&
                (!nearest || length(at - p_mm) < length(*nearest - p_mm) - 1e-9))
                nearest = at;
        return nearest;
    }

    /// Where the line through `at` along the unit vector n passes half way between what lies before and behind the edge
    /// there; voxels along n from `at`.
    std::optional<double> middle_on_line(Vec3 at, Vec3 n) const {
        constexpr int half = int(line_half / line_step), count = 2 * half + 1, wide = int(0.5 / line_step);
        std::vector<double> f(count);
        for (int i = 0; i < count; ++i) f[i] = value(at + ((i - half) * line_step * unit_mm_) * n);
        const auto slope = [&](int i) { return f[std::min(i + wide / 2, count - 1)] - f[std::max(i - wide / 2, 0)]; };
        int steep = half;
        for (int i = half - 3 * wide; i <= half + 3 * wide; ++i)
            if (slope(i) > slope(steep)) steep = i;
        const double least = flat * slope(steep);
        if (!(least > 0)) return {};
        int low = steep, high = steep;
        while (low > 0 && slope(low) > least) --low;
        while (high + 1 < count && slope(high) > least) ++high;
        const double middle = 0.5 * (f[low] + f[high]);
        for (int i = low; i < high; ++i)
            if (f[i] <= middle && middle < f[i + 1])
                return (i - half + (middle - f[i]) / (f[i + 1] - f[i])) * line_step;
        return {};
    }

    std::optional<Vec3> snap(Vec3 p_mm, double reach_mm) const {
        std::optional<Vec3> on = nearest_edge(p_mm, reach_mm);
        // Along the normal of the edge, through the place itself: after three steps the normal is that of the foot.
        for (int step = 0; step < 3 && on; ++step) {
            const Vec3 n = normal_at(*on), foot = p_mm + dot(*on - p_mm, n) * n;
            const auto along = middle_on_line(foot, n);
            if (!along) return {};
            on = foot + (*along * unit_mm_) * n;
        }
        return on && length(*on - p_mm) <= reach_mm ? on : std::nullopt;
    }

private:
    Reader<Voxel> reader_;
    const Geometry& geometry_;
    double unit_mm_, least_ = 0;
    std::optional<Vec3> normal_;
};

}  // namespace

std::optional<Vec3> snap_to_surface(const DeviceVolume& volume, Vec3 p_mm, double reach_mm,
                                    std::optional<Vec3> normal) {
    if (!(reach_mm >= 0)) throw Error(ErrorCode::usage, "snap: the reach must not be below 0");
    if (normal && !(length(*normal) > 0)) throw Error(ErrorCode::usage, "snap: the plane's normal must not be 0");
    const DeviceVolume::Data& data = volume.data();
    return with_stored_voxel(data,
                             [&](auto voxel) { return Edges<decltype(voxel)>(data, normal).snap(p_mm, reach_mm); });
}

std::optional<Vec3> snap_to_surface(const BrickSource& source, const DeviceVolume& whole, Vec3 p_mm, double reach_mm,
                                    std::optional<Vec3> normal) {
    const SourceLevel& finest = source.levels().front();
    // A foot that is followed lies within reach; lines and means of gradients go on from there.
    const double unit_mm = finest.geometry.smallest_spacing_mm(), far = std::min(reach_mm / unit_mm, max_voxels);
    const double around_mm = (2 * far + line_half + 4) * unit_mm;
    const Vec3 p = finest.geometry.voxel_from_world(p_mm);
    Vec3 low = p, high = p;
    for (int axis = 0; axis < 3; ++axis) {
        const double voxels = around_mm / finest.geometry.spacing_mm[axis];
        low[axis] -= voxels, high[axis] += voxels;
    }
    const VoxelBox box = box_around(finest, low, high);
    if (!(voxels_in(box) > 0)) return {};
    return snap_to_surface(part_of(source, 0, box, whole), p_mm, reach_mm, normal);
}

}  // namespace chiaro
