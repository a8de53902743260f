// Fields of labels on the grid of a volume.
#include <algorithm>
#include <cmath>

#include "classify/labels/fields.h"
#include "core/threads.h"
#include "volume/bricks.h"

namespace chiaro {
namespace {

/// A place among the labels' voxels: the first of eight, and the way to the next.
struct Place {
    bool beyond = false;
    std::array<std::size_t, 8> voxel{};
    std::array<float, 8> weight{};
};

class Sampler {
public:
    Sampler(const LabelFields& fields, const LabelPlacement& placement) : fields_(fields), placed_(placement) {
        const auto& a = placement.axes;
        // A distance is told in the labels' voxels, and wanted in the volume's.
        scale_ = placement.is_same_grid ? 1 : float(1 / std::cbrt(std::abs(dot(a[0], cross(a[1], a[2])))));
    }

    Place at(int x, int y, int z) const {
        const Vec3 p = placed_.offset + x * placed_.axes[0] + y * placed_.axes[1] + z * placed_.axes[2];
        Place place;
        std::array<std::array<std::size_t, 2>, 3> i;
        std::array<float, 3> t;
        for (int axis = 0; axis < 3; ++axis) {
            const int n = fields_.dimensions[std::size_t(axis)];
            place.beyond = place.beyond || p[axis] < -0.5 || p[axis] > n - 0.5;
            const double q = std::clamp(p[axis], 0.0, n - 1.0);
            const int low = std::min(int(q), std::max(n - 2, 0));
            i[std::size_t(axis)] = {std::size_t(low), std::size_t(std::min(low + 1, n - 1))};
            t[std::size_t(axis)] = float(q - low);
        }
        for (std::size_t c = 0; c < 8; ++c) {
            const std::size_t cx = c & 1, cy = c >> 1 & 1, cz = c >> 2;
            place.voxel[c] =
                (i[2][cz] * std::size_t(fields_.dimensions[1]) + i[1][cy]) * std::size_t(fields_.dimensions[0]) +
                i[0][cx];
            place.weight[c] = (cx ? t[0] : 1 - t[0]) * (cy ? t[1] : 1 - t[1]) * (cz ? t[2] : 1 - t[2]);
        }
        return place;
    }

    std::uint8_t distance(const Place& place) const {
        if (place.beyond) return fields_.distance_beyond;
        const float voxels = scale_ * (mean(place, fields_.distance, 1, 0) - LabelCoding::middle);
        return std::uint8_t(
            std::clamp(voxels + LabelCoding::middle, float(LabelCoding::hidden), float(LabelCoding::shown)) + 0.5f);
    }
    std::uint8_t share(const Place& place) const {
        return place.beyond ? fields_.share_beyond : std::uint8_t(mean(place, fields_.share, 1, 0) + 0.5f);
    }
    std::uint8_t share_by(std::size_t transfer, const Place& place) const {
        if (place.beyond) return transfer == 0 ? 255 : 0;
        return std::uint8_t(mean(place, fields_.transfers[transfer].share, 1, 0) + 0.5f);
    }
    std::uint32_t tint(const Place& place) const {
        if (place.beyond) return fields_.tint_beyond;
        std::uint32_t packed = 0;
        for (std::size_t c = 0; c < 4; ++c) packed |= std::uint32_t(mean(place, fields_.tint, 4, c) + 0.5f) << (8 * c);
        return packed;
    }

private:
    static float mean(const Place& place, const VoxelBuffer& bytes, std::size_t stride, std::size_t channel) {
        float sum = 0;
        for (std::size_t c = 0; c < 8; ++c)
            sum += place.weight[c] * float(std::to_integer<int>(bytes.data()[place.voxel[c] * stride + channel]));
        return sum;
    }

    const LabelFields& fields_;
    const LabelPlacement& placed_;
    float scale_;
};

/// Calls f(voxel, whether `holds` of it and of the seven others of the cell that begins with it) for a brick's voxels.
template <class Holds, class Function>
void each_cell(const Holds& holds, const Function& f) {
    constexpr int row = brick_row, last = brick_row - 1;
    for (int z = 0; z < row; ++z)
        for (int y = 0; y < row; ++y)
            for (int x = 0; x < row; ++x) {
                const std::size_t at = std::size_t((z * row + y) * row + x);
                bool all = z < last && y < last && x < last;
                for (int corner = 0; corner < 8 && all; ++corner)
                    all = holds(at, at + std::size_t(((corner >> 2) * row + (corner >> 1 & 1)) * row + (corner & 1)));
                f(at, all);
            }
}

/// Marks what lies deep in what is shown.
void mark_deep(std::uint8_t* distance) {
    constexpr int whole = LabelCoding::middle + int(LabelCoding::per_voxel / 2 + 1);
    each_cell(
        [&](std::size_t from, std::size_t to) { return distance[from] >= LabelCoding::shown && distance[to] >= whole; },
        [&](std::size_t at, bool all) {
            if (all) distance[at] = LabelCoding::deep;
        });
}

/// From a strength of 255 to the words that kernels read.
void code_tints(std::uint32_t* tint) {
    constexpr std::uint32_t color = TintCoding::several - 1, most = TintCoding::strength_bits;
    for (int i = 0; i < brick_voxels; ++i)
        tint[i] = (tint[i] & color) | (((tint[i] >> 24) * most + 127) / 255) << TintCoding::strength_shift;
    const auto are_alike = [&](std::size_t from, std::size_t to) {
        return ((tint[from] ^ tint[to]) & ~TintCoding::several) == 0;
    };
    each_cell(are_alike, [&](std::size_t at, bool all) { tint[at] |= all ? 0 : TintCoding::several; });
}

}  // namespace

LabelBricks in_bricks(const LabelFields& fields, const LabelPlacement& placement, const std::array<int, 3>& dimensions,
                      int threads, const Progress& progress) {
    const auto [nx, ny, nz] = dimensions;
    const std::array<std::int64_t, 3> bricks{brick_count(nx), brick_count(ny), brick_count(nz)};
    const std::size_t voxels = std::size_t(bricks[0] * bricks[1] * bricks[2]) * brick_voxels + 4;
    LabelBricks made;
    if (fields.distance.size()) made.distance = VoxelBuffer(voxels);
    if (fields.share.size()) made.share = VoxelBuffer(voxels);
    if (fields.tint.size()) made.tint = VoxelBuffer(4 * voxels);
    for (const TransferShare& one : fields.transfers) made.transfers.push_back({one.transfer, VoxelBuffer(voxels)});
    auto* const distance = reinterpret_cast<std::uint8_t*>(made.distance.data());
    auto* const share = reinterpret_cast<std::uint8_t*>(made.share.data());
    auto* const tint = reinterpret_cast<std::uint32_t*>(made.tint.data());
    const Sampler sampler(fields, placement);
    parallel_for(threads, bricks[0] * bricks[1] * bricks[2], 1, [&](std::int64_t b, std::int64_t) {
        if (progress.cancelled()) return;
        const auto voxel = [&](std::int64_t brick, int i, int n) {
            return std::clamp(int(brick) * brick_edge - brick_before + i, 0, n - 1);
        };
        std::size_t to = std::size_t(b) * brick_voxels;
        for (int z = 0; z < brick_row; ++z)
            for (int y = 0; y < brick_row; ++y)
                for (int x = 0; x < brick_row; ++x, ++to) {
                    const Place at = sampler.at(voxel(b % bricks[0], x, nx), voxel(b / bricks[0] % bricks[1], y, ny),
                                                voxel(b / (bricks[0] * bricks[1]), z, nz));
                    if (distance) distance[to] = sampler.distance(at);
                    if (share) share[to] = sampler.share(at);
                    if (tint) tint[to] = sampler.tint(at);
                    for (std::size_t i = 0; i < made.transfers.size(); ++i)
                        made.transfers[i].share.data()[to] = std::byte(sampler.share_by(i, at));
                }
        if (distance) mark_deep(distance + std::size_t(b) * brick_voxels);
        if (tint) code_tints(tint + std::size_t(b) * brick_voxels);
    });
    progress.check();
    return made;
}

}  // namespace chiaro
