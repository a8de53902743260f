#include "classify/largest.h"

#include <chiaro/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "classify/clip.h"
#include "classify/kinds.h"
#include "core/threads.h"
#include "volume/device_view.h"
#include "volume/edited.h"

namespace chiaro {
namespace {

constexpr int kept_around = 2;  // voxels: what interpolation and gradients at the piece's surface touch

struct Run {
    int first, last;  ///< voxels of a row
    std::size_t piece;
};

/// Union-find; the root of a set is its first member.
class Sets {
public:
    std::size_t add() {
        parent_.push_back(parent_.size());
        return parent_.back();
    }
    std::size_t root(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    std::size_t size() const { return parent_.size(); }

private:
    std::vector<std::size_t> parent_;
};

/// Joins runs of two neighbouring rows that have voxels side by side.
void join_rows(const std::vector<Run>& a, const std::vector<Run>& b, Sets& sets) {
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (a[i].first <= b[j].last && b[j].first <= a[i].last) sets.join(a[i].piece, b[j].piece);
        a[i].last < b[j].last ? ++i : ++j;
    }
}

/// A byte for each voxel, by its stored value.
template <class OfValue>
std::vector<std::uint8_t> bytes_of(const DeviceVolume::Data& volume, const OfValue& of) {
    const auto [nx, ny, nz] = volume.dimensions;
    std::vector<std::uint8_t> all(std::size_t(nx) * ny * nz);
    with_stored_voxel(volume, [&](auto zero) {
        using Voxel = decltype(zero);
        std::vector<std::uint8_t> of_code;
        if constexpr (sizeof(Voxel) <= 2)
            for (int code = 0; code <= std::numeric_limits<Voxel>::max(); ++code) of_code.push_back(of(float(code)));
        const auto byte = [&, table = of_code.data()](Voxel stored) {
            if constexpr (sizeof(Voxel) <= 2) return table[stored];
            return of(float(stored));
        };
        parallel_for(volume.device.threads, nz, 1, [&](std::int64_t z, std::int64_t) {
            for (int y = 0; y < ny; ++y)
                for_each_run<Voxel>(volume, y, int(z), [&](int x, int count, const Voxel* from) {
                    std::transform(from, from + count, &all[(std::size_t(z) * ny + std::size_t(y)) * nx] + x, byte);
                });
        });
    });
    return all;
}

/// The kind of each voxel; where the clip cuts it away no part of a piece.
std::vector<std::uint8_t> kinds_of(const Medium::Data& medium, const Kinds& kinds) {
    const DeviceVolume::Data& volume = medium.volume.data();
    std::vector<std::uint8_t> all = bytes_of(volume, [&](float stored) { return kinds.of(stored); });
    const auto kept = half_spaces(medium.shape.clip, volume.geometry, volume.dimensions);
    if (kept.empty()) return all;
    const auto [nx, ny, nz] = volume.dimensions;
    parallel_for(volume.device.threads, nz, 1, [&](std::int64_t z, std::int64_t) {
        std::uint8_t* kind = &all[std::size_t(z) * ny * nx];
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++kind) {
                const Vec3 p{double(x), double(y), double(z)};
                const auto cuts = [&](const HalfSpace& h) { return dot(h.normal, p) > h.d; };
                if (*kind == 2 && std::any_of(kept.begin(), kept.end(), cuts)) *kind = 1;
            }
    });
    return all;
}

/// What is set at i - reach to i + reach of `length`, `stride` apart, for `count` neighbours side by side each.
void dilate(const std::uint8_t* from, int length, std::size_t stride, std::size_t count, int reach, std::uint8_t* to) {
    for (int i = 0; i < length; ++i) {
        std::uint8_t* row = to + std::size_t(i) * stride;
        std::memcpy(row, from + std::size_t(i) * stride, count);
        for (int k = std::max(0, i - reach); k <= std::min(length - 1, i + reach); ++k) {
            const std::uint8_t* other = from + std::size_t(k) * stride;
            for (std::size_t j = 0; k != i && j < count; ++j) row[j] |= other[j];
        }
    }
}

/// Whether a voxel or one within so many along each axis is set.
std::vector<std::uint8_t> dilated(std::vector<std::uint8_t> from, const std::array<int, 3>& n, int reach, int threads) {
    std::vector<std::uint8_t> to(from.size());
    const std::size_t nx = std::size_t(n[0]), slice = nx * std::size_t(n[1]);
    parallel_for(threads, std::int64_t(n[1]) * n[2], 64, [&](std::int64_t first, std::int64_t end) {
        for (std::size_t begin = std::size_t(first) * nx; begin < std::size_t(end) * nx; begin += nx) {
            std::copy_n(&from[begin], nx, &to[begin]);
            for (std::size_t k = 1; k <= std::min(std::size_t(reach), nx - 1); ++k)
                for (std::size_t x = 0; x < nx - k; ++x) {
                    to[begin + x] |= from[begin + x + k];
                    to[begin + x + k] |= from[begin + x];
                }
        }
    });
    parallel_for(threads, n[2], 1, [&](std::int64_t z, std::int64_t) {
        dilate(&to[std::size_t(z) * slice], n[1], nx, nx, reach, &from[std::size_t(z) * slice]);
    });
    parallel_for(threads, n[1], 1, [&](std::int64_t y, std::int64_t) {
        dilate(&from[std::size_t(y) * nx], n[2], slice, nx, reach, &to[std::size_t(y) * nx]);
    });
    return to;
}

/// Stored values that show nothing, and between which nothing is seen either: from one empty range of values to another
/// interpolation goes through what is visible.
struct EmptyRange {
    float low, high;
};

[[noreturn]] void refuse_to_leave_out() {
    throw Error(ErrorCode::usage, "--largest: the transfer function shows every value, so nothing can be left out");
}

/// Of the entries that show nothing, which lie in a row: [first, last] of each such row.
std::vector<std::pair<std::size_t, std::size_t>> empty_rows(const std::vector<std::uint8_t>& of_entry) {
    std::vector<std::pair<std::size_t, std::size_t>> rows;
    for (std::size_t j = 0; j < of_entry.size(); ++j) {
        if (of_entry[j] != 0) continue;
        if (!rows.empty() && rows.back().second + 1 == j)
            rows.back().second = j;
        else
            rows.push_back({j, j});
    }
    return rows;
}

/// Those that most voxels beside the piece have (`near`: a byte a voxel).
EmptyRange empty_range(const Medium::Data& medium, const Kinds& kinds, const std::vector<std::uint8_t>& near) {
    const DeviceVolume::Data& volume = medium.volume.data();
    if (kinds.is_iso()) {
        const auto outside = values_outside(volume, kinds.lowest, {volume.stored_min, volume.stored_max});
        if (!outside) refuse_to_leave_out();
        return {outside->first, std::max(outside->first, outside->second)};
    }
    const auto rows = empty_rows(kinds.of_entry);
    if (rows.empty()) refuse_to_leave_out();
    std::vector<std::uint8_t> row_of(kinds.of_entry.size(), 0);  // from 1 on; what there is more of shares a number
    const auto number = [](std::size_t r) { return std::uint8_t(std::min<std::size_t>(r, 254) + 1); };
    for (std::size_t r = 0; r < rows.size(); ++r)
        std::fill(&row_of[rows[r].first], &row_of[rows[r].second] + 1, number(r));
    const auto row = bytes_of(volume, [&](float stored) { return row_of[kinds.entry(stored)]; });
    std::array<std::uint64_t, 256> voxels{};
    constexpr std::uint64_t first_of_all = std::uint64_t(1) << 32;  // where there are none, those of the whole volume
    for (std::size_t i = 0; i < row.size(); ++i) voxels[row[i]] += near[i] ? first_of_all : 1;
    const auto most = std::max_element(voxels.begin() + 1, voxels.end()) - voxels.begin() - 1;
    const auto [first, last] = rows[std::min(std::size_t(most), rows.size() - 1)];
    const OpticalTable& table = medium.table;
    const auto stored = [&](std::size_t j) { return (double(j) - table.index_offset) / table.index_scale; };
    // The outermost entries stand for all that lies beyond.
    double low = first == 0 ? volume.stored_min : stored(first);
    double high = last + 1 == row_of.size() ? volume.stored_max : stored(last);
    if (volume.whole_numbers) low = std::ceil(low), high = std::floor(high);
    if (low > high) refuse_to_leave_out();
    return {float(low), float(high)};
}

}  // namespace

Pieces find_pieces(const std::vector<std::uint8_t>& voxels, std::array<int, 3> n, std::uint8_t least) {
    std::vector<std::vector<Run>> rows(std::size_t(n[1]) * n[2]);
    Sets sets;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y) {
            const std::size_t row = std::size_t(z) * n[1] + y;
            const std::uint8_t* voxel = &voxels[row * std::size_t(n[0])];
            for (int x = 0; x < n[0]; ++x) {
                if (voxel[x] < least) continue;
                const int first = x;
                while (x + 1 < n[0] && voxel[x + 1] >= least) ++x;
                rows[row].push_back({first, x, sets.add()});
            }
            if (y > 0) join_rows(rows[row - 1], rows[row], sets);
            if (z > 0) join_rows(rows[row - std::size_t(n[1])], rows[row], sets);
        }
    std::vector<std::size_t> sizes(sets.size());
    for (const auto& row : rows)
        for (const Run& run : row) sizes[sets.root(run.piece)] += std::size_t(run.last - run.first + 1);
    Pieces pieces;
    std::size_t best = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        pieces.count += sizes[i] > 0;
        if (sizes[i] > pieces.largest)
            pieces.second = std::exchange(pieces.largest, sizes[i]), best = i;
        else
            pieces.second = std::max(pieces.second, sizes[i]);
    }
    pieces.is_of_largest.assign(voxels.size(), 0);
    for (std::size_t row = 0; row < rows.size(); ++row)
        for (const Run& run : rows[row])
            if (sets.root(run.piece) == best)
                std::fill_n(
                    pieces.is_of_largest.begin() + std::ptrdiff_t(row * std::size_t(n[0]) + std::size_t(run.first)),
                    run.last - run.first + 1, std::uint8_t(1));
    return pieces;
}

std::optional<std::pair<float, float>> values_outside(const DeviceVolume::Data& volume, double lowest,
                                                      std::pair<float, float> of) {
    const double surface = (lowest - volume.offset) / volume.scale;
    const double range = double(volume.stored_max) - volume.stored_min;
    const double step = volume.whole_numbers ? 1 : std::max(1e-3 * range, 1e-6 * std::abs(surface));
    if (volume.scale > 0 ? surface <= of.first : surface >= of.second) return std::nullopt;
    return volume.scale > 0 ? std::pair(of.first, float(std::ceil(surface / step) * step - step))
                            : std::pair(float(std::floor(surface / step) * step + step), of.second);
}

DeviceVolume with_largest_piece(const Medium::Data& medium) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const Kinds kinds(medium);
    const auto all = kinds_of(medium, kinds);
    const Pieces pieces = find_pieces(all, volume.dimensions, 2);
    const int threads = volume.device.threads;
    auto near = dilated(pieces.is_of_largest, volume.dimensions, kept_around, threads);
    bool is_alone = kinds.is_iso() || empty_rows(kinds.of_entry).size() < 2;
    for (std::size_t i = 0; i < all.size() && is_alone; ++i)
        is_alone = all[i] == 0 || pieces.is_of_largest[i] || (all[i] == 1 && near[i]);
    if (is_alone) return medium.volume;
    const auto [low, high] = empty_range(medium, kinds, near);
    const auto beside = dilated(pieces.is_of_largest, volume.dimensions, 1, threads);
    // Means and smallest values along rays count what shows nothing, too.
    const bool counts_all = medium.shape.mode == Mode::mean || medium.shape.mode == Mode::minip;
    auto goes = bytes_of(
        volume, [low = low, high = high](float stored) -> std::uint8_t { return !(low <= stored && stored <= high); });
    parallel_for(threads, std::int64_t(goes.size()), 1 << 16, [&](std::int64_t first, std::int64_t end) {
        for (auto i = std::size_t(first); i < std::size_t(end); ++i) {
            const bool stays = all[i] == 0   ? beside[i] || counts_all
                               : all[i] == 1 ? near[i] != 0
                                             : pieces.is_of_largest[i] != 0;
            goes[i] &= !stays;
            near[i] = !near[i];  // from here on: what is bounded
        }
    });
    return edited(
        medium.volume, goes, [low = low, high = high](float stored) { return std::clamp(stored, low, high); },
        std::make_shared<CoefficientBounds>(CoefficientBounds{std::move(near), low, high}));
}

}  // namespace chiaro
