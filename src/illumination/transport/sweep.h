// One group of directions on its way through all planes of the light grid.
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include "illumination/transport/lattice.h"
#include "illumination/transport/opaque.h"
#include "illumination/transport/sweep_kernel.h"

namespace chiaro {

/// The two lattices of a grid.
struct Lattices {
    Lattice along_x, along_y;

    explicit Lattices(const std::array<int, 3>& count) : along_x(count, false), along_y(count, true) {}
    const Lattice& of(const SweepAxes& axes) const { return axes.major == 0 ? along_y : along_x; }
};

/// A field in both orders.
struct BothWays {
    LatticeField along_x, along_y;

    const float* of(const SweepAxes& axes) const { return (axes.major == 0 ? along_y : along_x).data(); }
};

/// The side of a cube of which a sweep's light comes: 0: +x, 1: -x, 2: +y ...
inline int side_of(const SweepAxes& axes) { return 2 * axes.major + (axes.sign < 0); }

/// What travels from plane to plane: for each ray or channel one number a cell, with a halo of one that holds what
/// comes from outside. Rows begin on a cache line; the halo after one may be the first number before the next. Each
/// plane overwrites the one before, two rows aside, from that end on: so both fit into the cache.
class TravellingPlanes {
public:
    TravellingPlanes(int nu, int nv, int max_fields);

    /// From one field's row to the next.
    int field() const { return row_; }
    /// Of the first cell of a row.
    std::int32_t place(int v) const { return (v + 1) * row_ * fields_ + margin; }
    /// Before the first plane.
    void start(int fields, float outside);
    /// The next plane; its rows are to be written from the first to the last, or from the last to the first.
    kernel::SweepPlane next();
    bool runs_upwards() const { return upwards_; }

private:
    static constexpr int margin = 16, aside = 2;
    void renew(int row);
    int nv_, row_, fields_ = 0;
    float outside_ = 0;
    bool upwards_ = false;
    LatticeField numbers_;
};

/// Rays of a batch as the kernels know them: those of one octant side by side.
struct SweepBatch {
    std::vector<int> directions;  ///< of each ray, among all
    std::vector<kernel::SweepRay> rays;
    std::vector<kernel::OctantRays> octants;
    std::vector<std::array<float, 3>> cosines;  ///< |cos| of the angles with the axes

    /// Those of the four cells before a ray that a pattern calls clear: their share.
    float open_share(int ray, int pattern) const;
    /// `open` of the octants, where rays weigh so much.
    void weigh(const std::vector<float>& weights);
};

/// A group in batches of much the same size, at most `most` each. A row of a plane holds `of_ray` numbers for each ray.
std::vector<SweepBatch> sweep_batches(const std::vector<Vec3>& directions, const SweepGroup& group, int most,
                                      int of_ray);

/// A row of a plane: where it lies in its lattice, and which opaque cells it holds.
struct SweptRow {
    int v;
    std::size_t at, next;  ///< in a field of the lattice; the row that follows
    kernel::OpaqueRow opaque;
};

/// Asks for a row long before it is read: what a sweep reads lies in pieces too short for the CPU to foresee.
inline void ask_for(const float* row, int count) {
    for (int i = 0; i < count; i += 16) __builtin_prefetch(row + i);
}

/// What opaque cells hold lies in another order than most sweeps meet them in.
inline void ask_for(const kernel::OpaqueRow& row, const std::vector<kernel::OctantRays>& octants) {
    for (const kernel::OpaqueCell& cell : std::span(row.cells, std::size_t(row.count))) {
        if (cell.id < row.shown) ask_for(row.arriving + std::ptrdiff_t(cell.id) * 24, 24);
        for (const kernel::OctantRays& rays : octants)
            if (row.emission) ask_for(row.seen_from(rays, cell.id), 4);
    }
}

/// Calls visit(plane, row) for the rows of one plane after the other, from the light's side. Returns early once
/// cancelled.
template <class Visit>
void for_each_row(const Lattice& lattice, const SweepAxes& axes, const OpaqueCells& cells, const float* emission,
                  float* arriving, const Progress& progress, TravellingPlanes& planes, const Visit& visit) {
    const auto& n = lattice.count();
    const int steps = n[axes.major], rows = n[axes.v];
    const auto cell = [&](int k, int v) {
        std::array<int, 3> first{0, 0, 0};
        first[axes.major] = axes.sign > 0 ? steps - 1 - k : k, first[axes.v] = v;
        return first;
    };
    const auto at = [&](int k, int v) {
        const auto [x, y, z] = cell(std::min(k, steps - 1), v);
        return lattice.index(x, y, z);
    };
    for (int k = 0; k < steps && !progress.cancelled(); ++k) {
        const kernel::SweepPlane plane = planes.next();
        const int first = planes.runs_upwards() ? 0 : rows - 1, step = planes.runs_upwards() ? 1 : -1;
        for (int i = 0; i < rows; ++i) {
            const int v = first + i * step;
            const auto [x, y, z] = cell(k, v);
            const auto opaque = lattice.along_y() ? cells.row(lattice, x, z) : cells.row(lattice, y, z);
            visit(plane, SweptRow{v,
                                  at(k, v),
                                  i + 1 < rows ? at(k, v + step) : at(k + 1, v),
                                  {opaque.data(), std::int32_t(opaque.size()), std::int32_t(cells.count()),
                                   std::int32_t(cells.listed()), emission, arriving}});
        }
    }
}

}  // namespace chiaro
