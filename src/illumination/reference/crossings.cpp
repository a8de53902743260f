#include "illumination/reference/crossings.h"

#include <limits>

namespace chiaro {

Crossings::Crossings(const ExtinctionCells& cells) : cells_(cells) {
    for (int axis = 0; axis < 3; ++axis) beyond_[axis].resize(std::size_t(cells.count()[axis]) + 1);
}

kernel::CellRays Crossings::along(Vec3 direction, int x, double start_half_voxels, Vec3 offset) {
    constexpr double never = std::numeric_limits<double>::infinity();
    const auto& count = cells_.count();
    double steepest = 0;
    std::array<double, 3> per_cell, to_wall,
        next;  // way from one wall to the next along each axis, and to the next one
    for (int axis = 0; axis < 3; ++axis) {
        const double slope = std::abs(direction[axis]);
        steepest = std::max(steepest, slope);
        per_cell[axis] = slope > 0 ? 1 / slope : never;
        to_wall[axis] = direction[axis] < 0 ? 0.5 + offset[axis] : 0.5 - offset[axis];
        next[axis] = slope > 0 ? to_wall[axis] / slope : never;
    }
    // The ray starts on the cube of that many half voxel widths; with 1 where it leaves its own cell.
    const double start = 0.5 * start_half_voxels / steepest;
    std::array<int, 3> moved{0, 0, 0};
    list_.clear();
    for (auto& beyond : beyond_) beyond[0] = 0;
    for (double at = start;;) {
        const int axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
        const auto away = [&](int a) { return direction[a] < 0 ? -moved[a] : moved[a]; };
        if (next[axis] > at) {
            const int distance =
                cells_.place(x + away(0)) - cells_.place(x) + away(1) * cells_.row() + away(2) * cells_.slice();
            list_.push_back({distance, float(next[axis] - at)});
            at = next[axis];
        }
        beyond_[axis][std::size_t(++moved[axis])] = int(list_.size());
        if (moved[axis] >= count[axis]) break;
        next[axis] = (moved[axis] + to_wall[axis]) * per_cell[axis];
    }
    for (int axis = 0; axis < 3; ++axis)
        std::fill(beyond_[axis].begin() + moved[axis] + 1, beyond_[axis].end(), int(list_.size()));
    const auto axis = [&](int a) {
        return kernel::CellRays::Axis{beyond_[a].data(), direction[a] >= 0, cells_.low(a), cells_.high(a),
                                      count[a] - 1};
    };
    return {cells_.address(), cells_.row(), cells_.slice(), list_.data(), axis(0), axis(1), axis(2)};
}

}  // namespace chiaro
