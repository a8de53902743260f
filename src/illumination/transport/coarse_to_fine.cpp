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

/// What a node holds.
struct NodeNumbers {
    float light[3], moment[9], scattered[12];
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
    NodeNumbers of(const TransportNodes& half, bool has_scattered) const {
        NodeNumbers found;
        add_up(half.light, found.light), add_up(half.moment, found.moment);
        if (has_scattered) add_up(half.scattered, found.scattered);
        return found;
    }

private:
    template <std::size_t count>
    void add_up(const std::vector<float>& numbers, float (&sums)[count]) const {
        float of[count]{};  // not told of outside: the compiler takes several at once
        for (int corner = 0; corner < 8; ++corner) {
            const float* from = numbers.data() + count * nodes_[corner];
            for (std::size_t i = 0; i < count; ++i) of[i] += weights_[corner] * from[i];
        }
        std::copy_n(of, count, sums);
    }

    std::size_t nodes_[8];
    float weights_[8];
};

/// Of one channel at one node: now on the coarse grid, before on both.
struct Detail {
    float detail, light, per_fine;  ///< per_fine: 0 where there is no detail

    Detail(float now, float was, float fine, bool has_detail)
        : detail(has_detail && was > 0 ? std::clamp(fine / was, 0.0f, max_detail) : 1),
          light(now * detail),
          per_fine(has_detail && fine > 0 ? light / fine : 0) {}
    float moment(float now, float was, float fine) const {
        float found = now * detail;
        if (per_fine > 0) found += (fine - was * detail) * per_fine;
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
        const bool has_scattered = !out.scattered.empty();
        const NodeNumbers now = at.of(half, has_scattered), was = at.of(before.half, has_scattered);
        const float *light = before.fine.light.data() + 3 * node, *moment = before.fine.moment.data() + 9 * node,
                    *scattered = has_scattered ? before.fine.scattered.data() + 12 * node : nullptr;
        for (std::size_t c = 0; c < 3; ++c) {
            const Detail of(now.light[c], was.light[c], light[c], has_detail);
            out.light[3 * node + c] = of.light;
            for (std::size_t i = 3 * c; i < 3 * c + 3; ++i)
                out.moment[9 * node + i] = of.moment(now.moment[i], was.moment[i], moment[i]);
            if (!has_scattered) continue;
            const Detail apart(now.scattered[c], was.scattered[c], scattered[c], has_detail);
            out.scattered[12 * node + c] = apart.light;
            for (std::size_t i = 3 + c; i < 12; i += 3)
                out.scattered[12 * node + i] = apart.moment(now.scattered[i], was.scattered[i], scattered[i]);
        }
    };
    parallel_for(device.threads, std::int64_t(ny) * nz, 8, [&, nx = nx, ny = ny](std::int64_t first, std::int64_t end) {
        for (std::int64_t row = first; row < end; ++row)
            for (int x = 0; x < nx; ++x) light_node(x, int(row % ny), int(row / ny));
    });
    return out;
}

}  // namespace chiaro
