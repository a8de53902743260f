#include "classify/medium.h"

namespace chiaro {
namespace {

/// Whether a sample that shows something looks up voxels of a brick: one in its 4³ cells or, where normals are means of
/// points around, up to three voxels beside them.
bool is_looked_up(const Medium::Data& medium, const std::array<int, 3>& brick) {
    constexpr int per_brick = brick_edge / cell_edge;
    const int beside = medium.volume.data().normal_reach[0] > 0 ? 1 : 0;
    const auto& count = medium.volume.data().cells.count;
    const auto first = [&](int axis) { return std::max(brick[axis] * per_brick - beside, 0); };
    const auto end = [&](int axis) { return std::min((brick[axis] + 1) * per_brick + beside, count[axis]); };
    for (int z = first(2); z < end(2); ++z)
        for (int y = first(1); y < end(1); ++y)
            for (int x = first(0); x < end(0); ++x)
                if (medium.cells[(std::size_t(z) * count[1] + y) * count[0] + x] & 1) return true;
    return false;
}

}  // namespace

void discard_unseen(const Medium& medium) {
    const Medium::Data& shown = medium.data();
    if (is_mixed(shown)) return;
    const RangeTest is_visible = visible_range(shown.table);
    const SplineCoding& spline = shown.volume.data().spline;
    const float zero = spline.least - spline.base * spline.scale;  // as a coefficient
    if (shown.shape.mode != Mode::dvr || is_visible(0, 0) || is_visible(zero, zero)) return;
    // What others see of a volume is constant; here none but this medium sees it, and it does not see what goes.
    auto& volume = const_cast<DeviceVolume::Data&>(shown.volume.data());
    const auto [nx, ny, nz] = volume.dimensions;
    const std::size_t bytes = brick_voxels * size_of(volume.stored);
    const auto discard = [&](std::size_t first, std::size_t end) {
        volume.bricks.discard(first * bytes, end * bytes);
        volume.coefficients.discard(first * bytes, end * bytes);
        if (volume.source) const_cast<DeviceVolume::Data*>(volume.source)->bricks.discard(first * bytes, end * bytes);
    };
    std::size_t brick = 0, first = 0;  // of the run of bricks that go
    for (int z = 0; z < brick_count(nz); ++z)
        for (int y = 0; y < brick_count(ny); ++y)
            for (int x = 0; x < brick_count(nx); ++x, ++brick)
                if (is_looked_up(shown, {x, y, z})) {
                    discard(first, brick);
                    first = brick + 1;
                }
    discard(first, brick);
}

}  // namespace chiaro
