#include "illumination/visibility/sweep_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chiaro {
namespace {

using kernel::SweepPack;

constexpr double log2_e = std::numbers::log2e;
constexpr std::size_t max_together = 80;

SweepAxes axes_of(Vec3 d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    const int major = z >= x && z >= y ? 2 : (y >= x ? 1 : 0);
    return {major, major == 0 ? 1 : 0, major == 2 ? 1 : 2, d[major] < 0 ? -1 : 1};
}

/// Share of the node `at` (-1, 0 or 1) in what lies at `shift` in [-1, 1]: linear.
double share(int at, double shift) {
    if (at == 0) return 1 - std::abs(shift);
    return std::max(at * shift, 0.0);
}

/// Those that lean to the same side lie between the same four nodes: whole packs of them come first, the rest is mixed.
void order(std::vector<SweepDirection>& directions) {
    std::vector<SweepDirection> sides[4], ordered;
    for (const SweepDirection& d : directions) sides[2 * (d.dv < 0) + (d.du < 0)].push_back(d);
    const auto whole = [](const auto& side) { return std::ptrdiff_t(side.size() - side.size() % SweepPack::width); };
    for (const auto& side : sides) ordered.insert(ordered.end(), side.begin(), side.begin() + whole(side));
    for (const auto& side : sides) ordered.insert(ordered.end(), side.begin() + whole(side), side.end());
    directions = std::move(ordered);
}

}  // namespace

kernel::SweptPlaces places_of(const SweepAxes& axes, int steps, const std::array<std::int64_t, 3>& strides,
                              std::int64_t origin) {
    const std::int64_t plane = strides[std::size_t(axes.major)];
    return {origin + (axes.sign > 0 ? (steps - 1) * plane : 0), axes.sign > 0 ? -plane : plane,
            strides[std::size_t(axes.v)], strides[std::size_t(axes.u)]};
}

std::vector<SweepGroup> sweep_groups(const std::vector<Vec3>& directions) {
    std::vector<SweepGroup> groups;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vec3 d = directions[i];
        const SweepAxes axes = axes_of(d);
        const auto same = [&](const SweepGroup& g) { return g.axes.major == axes.major && g.axes.sign == axes.sign; };
        auto group = std::find_if(groups.begin(), groups.end(), same);
        if (group == groups.end()) group = groups.insert(groups.end(), {axes, {}});
        const double length = 1 / std::abs(d[axes.major]);
        group->directions.push_back({int(i), d[axes.u] * length, d[axes.v] * length, length});
    }
    for (SweepGroup& group : groups) order(group.directions);
    return groups;
}

std::vector<DirectionBatch> direction_batches(const std::vector<SweepGroup>& groups) {
    std::vector<DirectionBatch> batches;
    for (const SweepGroup& group : groups)
        for (std::size_t first = 0; first < group.directions.size(); first += max_together) {
            const std::size_t count = std::min(max_together, group.directions.size() - first);
            batches.push_back({group.axes, std::span(group.directions).subspan(first, count)});
        }
    return batches;
}

void SweptDirections::weigh(int direction, std::array<double, max_coefficients>& weights) const {
    if (part.empty()) {
        const double weight = 4 * std::numbers::pi / double(towards.size());
        weights = spherical_harmonics(towards[std::size_t(direction)]);
        for (double& of : weights) of *= weight;
        return;
    }
    const int own = part[std::size_t(direction)];
    weights = {};
    weights[std::size_t(own)] = 1 / double(std::count(part.begin(), part.end(), own));
}

BatchHarmonics::BatchHarmonics(const SweptDirections& all, std::span<const SweepDirection> chosen, int coefficients)
    : sum_(kernel::Harmonics::width), count_(int(chosen.size())), coefficients_(coefficients) {
    std::array<double, max_coefficients> sum{}, weights;
    for (const SweepDirection& d : chosen) {
        all.weigh(d.index, weights);
        for (int c = 0; c < max_coefficients; ++c) {
            const bool used = c < coefficients;
            of_direction_.push_back(used ? float(weights[c]) : 0.0f);
            sum[c] += used ? weights[c] : 0;
        }
    }
    std::copy(sum.begin(), sum.end(), sum_.begin());
}

SweepPacks::SweepPacks(std::span<const SweepDirection> directions, int row, double start) {
    const std::size_t count = (directions.size() + SweepPack::width - 1) / SweepPack::width;
    numbers_.reserve(count);  // packs point into it
    for (std::size_t p = 0; p < count; ++p) {
        const std::size_t first = p * SweepPack::width;
        add(directions.subspan(first, std::min<std::size_t>(SweepPack::width, directions.size() - first)), row, start);
    }
}

void SweepPacks::add(std::span<const SweepDirection> directions, int row, double start) {
    Numbers& numbers = numbers_.emplace_back();
    numbers = {};
    SweepPack pack{};
    pack.weights = numbers.weights[0];
    pack.is_even = start == 0.25;
    pack.before = numbers.before, pack.outer = numbers.outer, pack.inner = numbers.inner;
    for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u) {
            float* weights = numbers.weights[pack.taps];
            float largest = 0;
            for (std::size_t i = 0; i < directions.size(); ++i) {
                weights[i] = float(share(u, directions[i].du) * share(v, directions[i].dv));
                largest = std::max(largest, weights[i]);
            }
            if (largest == 0) continue;
            pack.rows[pack.taps] = std::int8_t(v);
            pack.offset[pack.taps++] = v * row + u;
        }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const double length = directions[i].length;
        numbers.before[i] = float(-log2_e * 0.5 * length);
        numbers.outer[i] = float(-log2_e * std::max(0.5 - start, 0.0) * length);
        numbers.inner[i] = float(-log2_e * std::min(start, 0.5) * length);
    }
    packs_.push_back(pack);
}

}  // namespace chiaro
