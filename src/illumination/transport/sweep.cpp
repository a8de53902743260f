#include "illumination/transport/sweep.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chiaro {
namespace {

int octant_of(Vec3 w) { return (w.x < 0) | (w.y < 0) << 1 | (w.z < 0) << 2; }

/// To the four cells one plane back: along u, along v.
struct Taps {
    int u[4], v[4];

    explicit Taps(const SweepDirection& d) {
        for (int tap = 0; tap < 4; ++tap)
            u[tap] = tap & 1 ? (d.du < 0 ? -1 : 1) : 0, v[tap] = tap & 2 ? (d.dv < 0 ? -1 : 1) : 0;
    }
};

kernel::SweepRay ray_of(const SweepDirection& d, int row) {
    const Taps taps(d);
    const double u = std::abs(d.du), v = std::abs(d.dv);
    kernel::SweepRay ray{};
    for (int tap = 0; tap < 4; ++tap) {
        ray.offset[tap] = taps.v[tap] * row + taps.u[tap];
        ray.weight[tap] = float((tap & 1 ? u : 1 - u) * (tap & 2 ? v : 1 - v));
    }
    ray.edges = float(-std::numbers::log2e * d.length);
    return ray;
}

kernel::OctantRays octant_rays(const SweepDirection& d, const SweepAxes& axes, int octant) {
    constexpr int bits[]{1, 3, 9}, own = 13;  // of kernel::OpaqueCell::around
    const Taps taps(d);
    kernel::OctantRays rays{};
    rays.octant = octant;
    for (int tap = 0; tap < 4; ++tap)
        rays.back[tap] = own + axes.sign * bits[axes.major] + taps.v[tap] * bits[axes.v] + taps.u[tap] * bits[axes.u];
    return rays;
}

}  // namespace

TravellingPlanes::TravellingPlanes(int nu, int nv, int max_fields)
    : nv_(nv),
      row_((nu + 15) / 16 * 16 + margin),
      numbers_(std::size_t(row_) * std::size_t(nv + 2 + aside) * std::size_t(max_fields) + margin) {}

void TravellingPlanes::start(int fields, float outside) {
    fields_ = fields, outside_ = outside, upwards_ = false;
    std::fill(numbers_.begin(), numbers_.end(), outside);
}

void TravellingPlanes::renew(int row) {
    const std::ptrdiff_t length = std::ptrdiff_t(row_) * fields_;
    std::fill_n(numbers_.begin() + row * length, length, outside_);
}

kernel::SweepPlane TravellingPlanes::next() {
    // The plane before, high or low, left its halo where the one before it had cells.
    renew(upwards_ ? nv_ + 1 : aside);
    upwards_ = !upwards_;
    float* low = numbers_.data();
    float* high = low + std::ptrdiff_t(aside) * row_ * fields_;
    return upwards_ ? kernel::SweepPlane{high, low, row_} : kernel::SweepPlane{low, high, row_};
}

float SweepBatch::open_share(int ray, int pattern) const {
    float share = 0;
    for (int tap = 0; tap < 4; ++tap)
        if (pattern >> tap & 1) share += rays[std::size_t(ray)].weight[tap];
    return share;
}

void SweepBatch::weigh(const std::vector<float>& weights) {
    for (kernel::OctantRays& of : octants)
        for (int pattern = 0; pattern < kernel::OctantRays::patterns; ++pattern)
            for (int r = of.first; r < of.end; ++r)
                for (int axis = 0; axis < 3; ++axis)
                    if (open_share(r, pattern) >= kernel::least_open)
                        of.open[pattern][axis] += weights[std::size_t(r)] * cosines[std::size_t(r)][std::size_t(axis)];
}

std::vector<SweepBatch> sweep_batches(const std::vector<Vec3>& directions, const SweepGroup& group, int most,
                                      int of_ray) {
    std::vector<SweepDirection> sorted = group.directions;
    const auto octant = [&](const SweepDirection& d) { return octant_of(directions[std::size_t(d.index)]); };
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](const SweepDirection& a, const SweepDirection& b) { return octant(a) < octant(b); });
    const std::size_t count = (sorted.size() + std::size_t(most) - 1) / std::size_t(most);
    std::vector<SweepBatch> batches(count);
    for (std::size_t b = 0; b < count; ++b) {
        const std::size_t first = sorted.size() * b / count, end = sorted.size() * (b + 1) / count;
        SweepBatch& batch = batches[b];
        for (std::size_t i = first; i < end; ++i) {
            const SweepDirection& d = sorted[i];
            const Vec3 w = directions[std::size_t(d.index)];
            batch.directions.push_back(d.index);
            batch.rays.push_back(ray_of(d, of_ray * int(end - first)));
            batch.cosines.push_back({float(std::abs(w.x)), float(std::abs(w.y)), float(std::abs(w.z))});
            if (batch.octants.empty() || batch.octants.back().octant != octant(d)) {
                batch.octants.push_back(octant_rays(d, group.axes, octant(d)));
                batch.octants.back().first = std::int32_t(i - first);
            }
            batch.octants.back().end = std::int32_t(i - first) + 1;
        }
    }
    return batches;
}

}  // namespace chiaro
