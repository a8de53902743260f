#include "illumination/transport/coarse_to_fine.h"

#include <algorithm>

#include "core/threads.h"

namespace chiaro {
namespace {

constexpr float max_detail = 16;  ///< where the coarse grid was dark, its light tells little

/// Where a node of the fine grid lies between those of the coarse one, along an axis.
struct Between {
    int low, high;
    float share;  ///< of the higher

    Between(int fine, int count)
        : low(std::max((fine - 1) / 2, 0)),
          high(std::min(fine == 0 ? 0 : low + 1, count - 1)),
          share(fine % 2 == 0 ? 0.75f : 0.25f) {}
};

/// Numbers of coarse nodes, trilinear.
class HalfGrid {
public:
    HalfGrid(const CellGrid& grid, int x, int y, int z) {
        const Between on[3]{{x, grid.count[0]}, {y, grid.count[1]}, {z, grid.count[2]}};
        for (int corner = 0; corner < 8; ++corner) {
            int at[3];
            weights_[corner] = 1;
            for (int axis = 0; axis < 3; ++axis) {
                const bool is_high = corner >> axis & 1;
                at[axis] = is_high ? on[axis].high : on[axis].low;
                weights_[corner] *= is_high ? on[axis].share : 1 - on[axis].share;
            }
            nodes_[corner] = grid.index(at[0], at[1], at[2]);
        }
    }
    float of(const std::vector<float>& numbers, int per_node, int i) const {
        float sum = 0;
        for (int corner = 0; corner < 8; ++corner)
            sum += weights_[corner] * numbers[std::size_t(per_node) * nodes_[corner] + std::size_t(i)];
        return sum;
    }

private:
    std::size_t nodes_[8];
    float weights_[8];
};

/// Of one channel at one node: now on the coarse grid, before on both.
struct Detail {
    using Numbers = std::vector<float> TransportNodes::*;
    const HalfGrid& at;
    const TransportNodes& half;
    const LightBefore& before;
    std::size_t node;
    float detail, light, per_fine;  ///< per_fine: 0 where there is no detail

    Detail(const HalfGrid& place, const TransportNodes& now, const LightBefore& b, Numbers lights, int per_node, int i,
           std::size_t of, bool has_detail)
        : at(place), half(now), before(b), node(of) {
        const float was = at.of(before.half.*lights, per_node, i),
                    fine = (before.fine.*lights)[std::size_t(per_node) * node + std::size_t(i)];
        detail = has_detail && was > 0 ? std::clamp(fine / was, 0.0f, max_detail) : 1;
        light = at.of(half.*lights, per_node, i) * detail;
        per_fine = has_detail && fine > 0 ? light / fine : 0;
    }
    float moment(Numbers moments, int per_node, int i) const {
        float found = at.of(half.*moments, per_node, i) * detail;
        if (per_fine > 0)
            found += ((before.fine.*moments)[std::size_t(per_node) * node + std::size_t(i)] -
                      at.of(before.half.*moments, per_node, i) * detail) *
                     per_fine;
        return std::clamp(found, -std::abs(light), std::abs(light));
    }
};

bool is_solid(const TransportNodes& nodes, std::size_t node) { return nodes.weight[node] >= opaque_weight; }

}  // namespace

bool has_detail_for(const LightBefore& before, const CellGrid& fine, const CellGrid& half) {
    return before.fine.grid.count == fine.count && before.half.grid.count == half.count && before.fine.iterations > 0;
}

TransportNodes with_detail(const TransportMedium& fine, const TransportNodes& half, const LightBefore& before,
                           const Device& device) {
    TransportNodes out = unlit_nodes(fine);
    out.iterations = half.iterations, out.change = half.change;
    out.scattered.resize(before.fine.scattered.empty() ? 0 : 12 * out.grid.size());
    out.seen = half.seen;
    const auto [nx, ny, nz] = out.grid.count;
    const auto light_node = [&](int x, int y, int z) {
        const HalfGrid at(half.grid, x, y, z);
        const std::size_t node = out.grid.index(x, y, z);
        const bool has_detail = is_solid(out, node) == is_solid(before.fine, node);
        for (int c = 0; c < 3; ++c) {
            const Detail of(at, half, before, &TransportNodes::light, 3, c, node, has_detail);
            out.light[3 * node + std::size_t(c)] = of.light;
            for (int axis = 0; axis < 3; ++axis)
                out.moment[9 * node + std::size_t(3 * c + axis)] = of.moment(&TransportNodes::moment, 9, 3 * c + axis);
            if (out.scattered.empty()) continue;
            const Detail scattered(at, half, before, &TransportNodes::scattered, 12, c, node, has_detail);
            out.scattered[12 * node + std::size_t(c)] = scattered.light;
            for (int i = 3 + c; i < 12; i += 3)
                out.scattered[12 * node + std::size_t(i)] = scattered.moment(&TransportNodes::scattered, 12, i);
        }
    };
    parallel_for(device.threads, std::int64_t(ny) * nz, 8, [&, nx = nx, ny = ny](std::int64_t first, std::int64_t end) {
        for (std::int64_t row = first; row < end; ++row)
            for (int x = 0; x < nx; ++x) light_node(x, int(row % ny), int(row / ny));
    });
    return out;
}

}  // namespace chiaro
