// Fields of labels on the grid of a volume.
#include <algorithm>
#include <cmath>
#include <cstring>

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

/// Of one cell of a brick, whose first voxel this is, for LabelBricks::cells. Normals touch a voxel before and two
/// behind, of which the cell has one.
std::uint32_t code_of_cell(const std::uint8_t* distance, const std::uint8_t* share, const std::uint32_t* tint) {
    constexpr int row = brick_row, before = -1, behind = cell_edge + 1;
    const std::uint32_t one = tint ? *tint : 0;
    if (one & TintCoding::several) return TintCoding::several;
    for (int z = before; z <= behind; ++z)
        for (int y = before; y <= behind; ++y)
            for (int x = before; x <= behind; ++x) {
                const int at = (z * row + y) * row + x;
                if (distance && distance[at] < LabelCoding::shown) return TintCoding::several;
                const int least = std::min({x, y, z}), most = std::max({x, y, z});
                if (share && least >= 0 && most <= cell_edge && share[at] != 255) return TintCoding::several;
                if (tint && least >= 0 && most < cell_edge && tint[at] != one) return TintCoding::several;
            }
    return one;
}

/// Of all cells of a brick.
void code_cells(LabelBricks& labels, const std::array<std::int64_t, 3>& brick, std::int64_t number,
                const std::array<int, 3>& count) {
    constexpr int edge = brick_edge / cell_edge;
    const auto each = [&](int axis, const auto& f) {
        const int first = int(brick[std::size_t(axis)]) * edge;
        for (int i = 0; i < std::min(edge, count[std::size_t(axis)] - first); ++i)
            f(first + i, i * cell_edge + brick_before);
    };
    const auto at = [](auto* bytes, std::int64_t voxel) { return bytes ? bytes + voxel : nullptr; };
    const auto* const distance = reinterpret_cast<const std::uint8_t*>(labels.distance.data());
    const auto* const share = reinterpret_cast<const std::uint8_t*>(labels.share.data());
    const auto* const tint = reinterpret_cast<const std::uint32_t*>(labels.tint.data());
    each(2, [&](int z, int from_z) {
        each(1, [&](int y, int from_y) {
            each(0, [&](int x, int from_x) {
                const std::int64_t voxel = number * brick_voxels + (from_z * brick_row + from_y) * brick_row + from_x;
                labels.cells[(std::size_t(z) * std::size_t(count[1]) + std::size_t(y)) * std::size_t(count[0]) +
                             std::size_t(x)] = code_of_cell(at(distance, voxel), at(share, voxel), at(tint, voxel));
            });
        });
    });
}

}  // namespace

namespace {

/// Whether bricks need nothing of the tiles that have changed.
class Unchanged {
public:
    Unchanged(const LabelFields& fields, const LabelPlacement& placement, const OlderBricks* older)
        : fields_(fields), placed_(placement), older_(older) {}

    bool operator()(const std::array<std::int64_t, 3>& brick) const {
        if (!older_) return false;
        constexpr int edge = 32;
        std::array<std::int64_t, 3> first, last;  // tiles
        for (std::size_t a = 0; a < 3; ++a) {
            const int axis = int(a);
            double low = placed_.offset[axis], high = low;
            for (std::size_t b = 0; b < 3; ++b) {
                const double way = placed_.axes[b][axis], from = double(brick[b]) * brick_edge - brick_before;
                const double p = way * from, q = way * (from + brick_row);
                low += std::min(p, q), high += std::max(p, q);
            }
            const auto tile = [&](double voxel) {
                return std::clamp<std::int64_t>(std::int64_t(std::floor(voxel / edge)), 0, fields_.tiles[a] - 1);
            };
            first[a] = tile(low - 1), last[a] = tile(high + 1);
        }
        for (auto z = first[2]; z <= last[2]; ++z)
            for (auto y = first[1]; y <= last[1]; ++y)
                for (auto x = first[0]; x <= last[0]; ++x)
                    if (older_->tiles[std::size_t((z * fields_.tiles[1] + y) * fields_.tiles[0] + x)]) return false;
        return true;
    }

private:
    const LabelFields& fields_;
    const LabelPlacement& placed_;
    const OlderBricks* older_;
};

/// One brick of what labels make of a volume, from the labels' fields or from older bricks.
class BrickFiller {
public:
    BrickFiller(const Sampler& sampler, const std::array<int, 3>& dimensions, LabelBricks& made)
        : sampler_(sampler),
          dimensions_(dimensions),
          made_(made),
          distance_(reinterpret_cast<std::uint8_t*>(made.distance.data())),
          share_(reinterpret_cast<std::uint8_t*>(made.share.data())),
          tint_(reinterpret_cast<std::uint32_t*>(made.tint.data())) {}

    void fill(const std::array<std::int64_t, 3>& brick, std::int64_t number) const {
        const auto voxel = [&](int axis, int i) {
            const auto a = std::size_t(axis);
            return std::clamp(int(brick[a]) * brick_edge - brick_before + i, 0, dimensions_[a] - 1);
        };
        const std::size_t first = std::size_t(number) * brick_voxels;
        std::size_t to = first;
        for (int z = 0; z < brick_row; ++z)
            for (int y = 0; y < brick_row; ++y)
                for (int x = 0; x < brick_row; ++x, ++to) {
                    const Place at = sampler_.at(voxel(0, x), voxel(1, y), voxel(2, z));
                    if (distance_) distance_[to] = sampler_.distance(at);
                    if (share_) share_[to] = sampler_.share(at);
                    if (tint_) tint_[to] = sampler_.tint(at);
                    for (std::size_t i = 0; i < made_.transfers.size(); ++i)
                        made_.transfers[i].share.data()[to] = std::byte(sampler_.share_by(i, at));
                }
        if (distance_) mark_deep(distance_ + first);
        if (tint_) code_tints(tint_ + first);
    }

    void copy(const LabelBricks& from, std::int64_t number) const {
        const auto take = [&](VoxelBuffer& to, const VoxelBuffer& old, std::size_t bytes) {
            const std::size_t first = bytes * std::size_t(number) * brick_voxels;
            if (to.size()) std::memcpy(to.data() + first, old.data() + first, bytes * brick_voxels);
        };
        take(made_.distance, from.distance, 1), take(made_.share, from.share, 1), take(made_.tint, from.tint, 4);
        for (std::size_t i = 0; i < made_.transfers.size(); ++i)
            take(made_.transfers[i].share, from.transfers[i].share, 1);
    }

private:
    const Sampler& sampler_;
    const std::array<int, 3>& dimensions_;
    LabelBricks& made_;
    std::uint8_t *distance_, *share_;
    std::uint32_t* tint_;
};

}  // namespace

LabelBricks in_bricks(const LabelFields& fields, const LabelPlacement& placement, const std::array<int, 3>& dimensions,
                      int threads, const Progress& progress, const OlderBricks* older) {
    const auto [nx, ny, nz] = dimensions;
    const std::array<std::int64_t, 3> bricks{brick_count(nx), brick_count(ny), brick_count(nz)};
    const std::size_t voxels = std::size_t(bricks[0] * bricks[1] * bricks[2]) * brick_voxels + 4;
    LabelBricks made;
    if (fields.distance.size()) made.distance = VoxelBuffer(voxels);
    if (fields.share.size()) made.share = VoxelBuffer(voxels);
    if (fields.tint.size()) made.tint = VoxelBuffer(4 * voxels);
    for (const TransferShare& one : fields.transfers) made.transfers.push_back({one.transfer, VoxelBuffer(voxels)});
    const std::array<int, 3> cells{cell_count(nx), cell_count(ny), cell_count(nz)};
    made.cells.resize(std::size_t(cells[0]) * std::size_t(cells[1]) * std::size_t(cells[2]));
    const Sampler sampler(fields, placement);
    const BrickFiller filler(sampler, dimensions, made);
    const Unchanged is_unchanged(fields, placement, older);
    parallel_for(threads, bricks[0] * bricks[1] * bricks[2], 1, [&](std::int64_t b, std::int64_t) {
        if (progress.cancelled()) return;
        const std::array<std::int64_t, 3> brick{b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])};
        if (is_unchanged(brick))
            filler.copy(older->bricks, b);
        else
            filler.fill(brick, b);
        code_cells(made, brick, b, cells);
    });
    progress.check();
    return made;
}

}  // namespace chiaro
