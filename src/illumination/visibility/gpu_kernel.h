// Sweeps as a GPU's threads do them: batches of directions side by side, plane by plane; first a thread for each node
// (or point of a lattice) and direction, which takes the light there, then one for each node and coefficient.
#pragma once
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/sheared_kernel.h"
#include "illumination/visibility/sweep_kernel.h"
#include "illumination/visibility/swept_places.h"

namespace chiaro::kernel {

enum SideWork : std::int32_t { starting, travelling, projecting, kinds_of_work };

/// The nodes as a batch of directions meets them. Pointers are the GPU's.
struct SweptNodes {
    std::int32_t nu, nv, steps;
    SweptPlaces places;
    const float* density;  ///< of the grid
    Harmonics harmonics;
    float* field;                       ///< of the grid: coefficients, to be added to
    float* seen;                        ///< by the directions, from the nodes of a plane
    std::int32_t first[kinds_of_work];  ///< thread, of the batches side by side

    CHIARO_INLINE float* field_at(std::int32_t k, std::int32_t v, std::int32_t u) const {
        return field + places.at(k, v, u) * harmonics.coefficients;
    }
};

/// A batch whose light is kept at the nodes. Of a plane with a halo of one: row × (nv + 2) nodes.
struct GridSide {
    SweptNodes nodes;
    const SweepPack* packs;
    float *density[2], *light[2];
    std::uint8_t *state[2], *is_lit[2];  ///< by any direction (all who write write the same): to be projected
    std::int32_t row, lanes;

    /// Threads that a plane takes, and numbers of `light`.
    CHIARO_INLINE std::int32_t threads() const { return nodes.nu * nodes.nv * lanes; }
    CHIARO_INLINE std::int32_t numbers() const { return row * (nodes.nv + 2) * lanes; }
    /// What it needs room for, and takes: floats.
    std::int64_t room() const { return std::int64_t(numbers()) * 2 + threads() + numbers() / lanes * 3; }
    void take(float* memory) {
        const std::int64_t plane = numbers(), places = plane / lanes;
        light[0] = memory, light[1] = memory + plane, nodes.seen = memory + 2 * plane;
        density[0] = nodes.seen + threads(), density[1] = density[0] + places;
        state[0] = reinterpret_cast<std::uint8_t*>(density[1] + places), state[1] = state[0] + places;
        is_lit[0] = state[1] + places, is_lit[1] = is_lit[0] + places;
    }

    /// Before the first plane there is nothing, and all light arrives.
    CHIARO_INLINE void start(std::int32_t i) const {
        for (int p = 0; p < 2; ++p) {
            light[p][i] = 1;
            if (i < numbers() / lanes) density[p][i] = 0, state[p][i] = clear | empty, is_lit[p][i] = 0;
        }
    }
    CHIARO_INLINE void travel(std::int32_t k, std::int32_t i) const {
        const std::int32_t d = i % lanes, node = i / lanes, u = node % nodes.nu, v = node / nodes.nu;
        if (d == 0) is_lit[1 - (k & 1)][place(v, u)] = 0;  // for the next plane
        if (d < nodes.harmonics.directions &&
            at(k).at(place(v, u), d, nodes.density[nodes.places.at(k, v, u)], nodes.seen + i))
            is_lit[k & 1][place(v, u)] = 1;
    }
    CHIARO_INLINE void project(std::int32_t k, std::int32_t v, std::int32_t u, std::int32_t c) const {
        if (!is_lit[k & 1][place(v, u)]) return;
        at(k).project_at(place(v, u), c, nodes.seen + std::int64_t(v * nodes.nu + u) * lanes, nodes.field_at(k, v, u));
    }

private:
    CHIARO_INLINE std::int32_t place(std::int32_t v, std::int32_t u) const { return (v + 1) * row + u + 1; }
    CHIARO_INLINE SweepKernel at(std::int32_t k) const {
        const std::int32_t here = k & 1, before = 1 - here;
        return {packs,
                nodes.harmonics,
                {density[before], density[here], light[before], light[here], state[before], state[here], row,
                 lanes / SweepPack::width}};
    }
};

/// A batch whose light is kept along its rays. `nodes.density` has a halo of one node that holds none.
struct ShearedSide {
    SweptNodes nodes;
    const ShearedDirection* rays;  ///< [plane][direction]
    SweptPlaces with_halo;
    float* light[2];
    std::int32_t row, origin;  ///< point (0, 0)
    std::int64_t direction;    ///< from one direction's points to the next one's

    CHIARO_INLINE std::int32_t threads() const { return (nodes.nu + 1) * (nodes.nv + 1) * nodes.harmonics.directions; }
    CHIARO_INLINE std::int32_t numbers() const { return std::int32_t(direction) * nodes.harmonics.directions; }
    std::int64_t room() const { return std::int64_t(numbers()) * 2 + threads(); }
    void take(float* memory) {
        light[0] = memory, light[1] = memory + numbers(), nodes.seen = memory + 2 * std::int64_t(numbers());
    }

    CHIARO_INLINE void start(std::int32_t i) const { light[0][i] = light[1][i] = 1; }
    CHIARO_INLINE void travel(std::int32_t k, std::int32_t item) const {
        const std::int32_t columns = nodes.nu + 1, rows = nodes.nv + 1;
        const std::int32_t i = item % columns - 1, j = item / columns % rows - 1, d = item / columns / rows;
        at(k).point(d, i, j, nodes.seen + std::int64_t(d * nodes.nv + j) * nodes.nu + i);
    }
    CHIARO_INLINE void project(std::int32_t k, std::int32_t v, std::int32_t u, std::int32_t c) const {
        const float* seen = nodes.seen + v * nodes.nu + u;
        float* field = nodes.field_at(k, v, u);
        nodes.harmonics.project_at<float, 1>(c, &seen, nodes.nu * nodes.nv, &field);
    }

private:
    CHIARO_INLINE ShearedKernel at(std::int32_t k) const {
        return {rays + std::int64_t(k) * nodes.harmonics.directions,
                nodes.harmonics,
                {nodes.density + with_halo.at(k, 0, 0), std::int32_t(with_halo.row), light[1 - (k & 1)] + origin,
                 light[k & 1] + origin, row, direction}};
    }
};

/// A side, and which of its threads.
template <class Side>
struct SideThread {
    const Side& side;
    std::int32_t i;
};

/// Sides next to each other, each with as many threads as it needs: `first` of them is told for each kind of work.
template <class Side>
struct Sides {
    const Side* at;
    std::int32_t count;

    CHIARO_INLINE SideThread<Side> thread(SideWork work, std::int64_t i) const {
        std::int32_t s = count - 1;
        while (i < at[s].nodes.first[work]) --s;
        return {at[s], std::int32_t(i) - at[s].nodes.first[work]};
    }
};

template <class Side>
struct StartSides {
    Sides<Side> sides;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const auto [side, i] = sides.thread(starting, item);
        side.start(i);
    }
};
template <class Side>
struct TravelSides {
    Sides<Side> sides;
    std::int32_t k;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const auto [side, i] = sides.thread(travelling, item);
        side.travel(k, i);
    }
};
template <class Side>
struct ProjectSides {
    Sides<Side> sides;
    std::int32_t k;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const auto [side, i] = sides.thread(projecting, item);
        const std::int32_t coefficients = side.nodes.harmonics.coefficients, node = i / coefficients;
        side.project(k, node / side.nodes.nu, node % side.nodes.nu, i % coefficients);
    }
};

/// Batches that were side by side, in their order.
struct AddParts {
    float* field;
    const float* parts;  ///< [part], `numbers` each
    std::int64_t numbers;
    std::int32_t count;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        float sum = field[i];
        for (std::int32_t p = 0; p < count; ++p) sum += parts[p * numbers + i];
        field[i] = sum;
    }
};

struct AddStepParts {
    AddSteps add;
    std::uint16_t* sums;
    const float* parts;
    std::int64_t numbers;
    std::int32_t count;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const float per_unit = add.per_unit[i % add.coefficients];
        for (std::int32_t p = 0; p < count; ++p) AddSteps::add(parts[p * numbers + i] * per_unit, sums + i);
    }
};

/// Copies a grid to where it has a halo.
struct SpreadKernel {
    std::int32_t nx, ny;
    std::int64_t stride[3];
    const float* from;
    float* to;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const std::int64_t row = i / nx;
        to[i % nx * stride[0] + row % ny * stride[1] + row / ny * stride[2]] = from[i];
    }
};

}  // namespace chiaro::kernel
