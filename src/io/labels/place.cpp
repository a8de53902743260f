// Where labels lie in a volume.
#include <chiaro/error.h>
#include <chiaro/labels.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace chiaro {
namespace {

Vec3 unit(int axis) {
    Vec3 v;
    v[axis] = 1;
    return v;
}

bool meets(const LabelPlacement& p, const std::array<int, 3>& volume, const std::array<int, 3>& labels) {
    for (int axis = 0; axis < 3; ++axis) {
        double low = p.offset[axis], high = low;
        for (int a = 0; a < 3; ++a) {
            const double way = (volume[std::size_t(a)] - 1) * p.axes[std::size_t(a)][axis];
            (way < 0 ? low : high) += way;
        }
        if (high < -0.5 || low > labels[std::size_t(axis)] - 0.5) return false;
    }
    return true;
}

bool is_identity(const LabelPlacement& p) {
    constexpr double close = 0.01;  // of a voxel, over the whole volume: what headers round
    bool same = length(p.offset) < close;
    for (int a = 0; a < 3; ++a) same = same && length(p.axes[std::size_t(a)] - unit(a)) < close / 1000;
    return same;
}

}  // namespace

LabelPlacement place_labels(const LabelVolume& labels, const std::array<int, 3>& dimensions, const Geometry& geometry) {
    const Geometry own = labels.geometry.in_frame(geometry.world);
    LabelPlacement placed{{}, {unit(0), unit(1), unit(2)}, true};
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorCode::input, one_line(labels.source) + ": " + what);
    };
    if ((own.world == World::unknown) != (geometry.world == World::unknown)) {
        if (labels.dimensions == dimensions) return placed;
        refuse(
            fmt::format("its labels lie in {}, the volume in {}: only where both have as many voxels do they belong "
                        "together without a frame",
                        own.world == World::unknown ? "no known frame" : "a known frame",
                        own.world == World::unknown ? "a known one" : "none"));
    }
    const auto voxel = [&](Vec3 p) { return own.voxel_from_world(geometry.world_from_voxel(p)); };
    placed.offset = voxel({});
    for (int a = 0; a < 3; ++a) placed.axes[std::size_t(a)] = voxel(unit(a)) - placed.offset;
    placed.is_same_grid = labels.dimensions == dimensions && is_identity(placed);
    if (placed.is_same_grid) return {{}, {unit(0), unit(1), unit(2)}, true};
    if (!meets(placed, dimensions, labels.dimensions))
        refuse("its labels lie beside the volume: the two are not of the same frame");
    return placed;
}

}  // namespace chiaro
