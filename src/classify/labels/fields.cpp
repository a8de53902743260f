#include "classify/labels/fields.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "classify/labels/border.h"
#include "core/srgb.h"
#include "core/threads.h"

namespace chiaro {
namespace {

constexpr int edge = BorderTile::edge;
constexpr std::size_t max_tints = 16;  ///< that have borders of their own within a tile

struct Tint {
    std::array<float, 3> root{};  ///< of red, green, blue
    float strength = 0;
    auto operator<=>(const Tint&) const = default;
};

/// Labels by what they look like.
struct Looks {
    std::vector<std::uint8_t> shown;     ///< of each number
    std::vector<float> opacity;          ///< of each number
    std::vector<std::uint16_t> tint_of;  ///< of each number
    std::vector<float> opacities;        ///< of what is shown, rising
    std::vector<Tint> tints;
    std::vector<std::optional<TransferFunction>> transfers{std::nullopt};
    std::vector<std::uint16_t> transfer_of;  ///< of each number
    bool hides = false, dims = false, paints = false;

    Looks(const std::vector<Label>& labels, ColorMode color) {
        std::map<Tint, std::uint16_t> known;
        for (const Label& label : labels) {
            const bool is_shown = label.show && label.opacity > 0;
            Tint tint{{}, is_shown ? float(label.tint) : 0};
            for (std::size_t c = 0; tint.strength > 0 && c < 3; ++c)
                tint.root[c] =
                    float(std::sqrt(color == ColorMode::linear ? linear_from_srgb(label.rgb[c]) : label.rgb[c]));
            shown.push_back(is_shown), opacity.push_back(float(label.opacity));
            tint_of.push_back(known.try_emplace(tint, std::uint16_t(known.size())).first->second);
            transfer_of.push_back(number_of(is_shown ? label.transfer : std::nullopt));
            hides = hides || !is_shown, paints = paints || tint.strength > 0;
            if (is_shown) opacities.push_back(float(label.opacity));
        }
        tints.resize(known.size());
        for (const auto& [tint, number] : known) tints[number] = tint;
        std::sort(opacities.begin(), opacities.end());
        opacities.erase(std::unique(opacities.begin(), opacities.end()), opacities.end());
        dims = !opacities.empty() && opacities.front() < 1;
    }
    bool has_transfers() const { return transfers.size() > 1; }

private:
    std::uint16_t number_of(const std::optional<TransferFunction>& transfer) {
        const auto known = std::find(transfers.begin(), transfers.end(), transfer);
        if (known != transfers.end()) return std::uint16_t(known - transfers.begin());
        if (transfers.size() > max_label_transfers)
            throw Error(ErrorCode::input, "labels: at most " + std::to_string(max_label_transfers) +
                                              " transfer functions of their own can be shown");
        transfers.push_back(transfer);
        return std::uint16_t(transfers.size() - 1);
    }
};

std::uint8_t byte(float share) { return std::uint8_t(std::clamp(share, 0.0f, 1.0f) * 255 + 0.5f); }
std::uint32_t packed(const std::array<float, 3>& root, float strength) {
    return byte(root[0]) | std::uint32_t(byte(root[1])) << 8 | std::uint32_t(byte(root[2])) << 16 |
           std::uint32_t(byte(strength)) << 24;
}
std::uint32_t packed(const Tint& tint) { return packed(tint.root, tint.strength); }

/// One tile after the other, a thread's own.
class Tiles {
public:
    Tiles(const LabelVolume& labels, const Looks& looks, LabelFields& out)
        : labels_(labels),
          looks_(looks),
          out_(out),
          tile_(border_widths(labels.geometry.spacing_mm)),
          numbers_(std::size_t(row) * row * row),
          inside_(numbers_.size()) {}

    void fill(std::array<int, 3> at) {
        first_ = at;
        load();
        if (looks_.hides) fill_distance();
        if (looks_.dims) fill_share();
        if (looks_.paints) fill_tint();
        if (looks_.has_transfers()) fill_transfers();
    }

private:
    void load() {
        const auto [nx, ny, nz] = labels_.dimensions;
        const auto numbers = labels_.numbers();
        for (int z = 0; z < row; ++z)
            for (int y = 0; y < row; ++y) {
                const auto within = [&](int i, int n) { return std::size_t(std::clamp(i - halo, 0, n - 1)); };
                const std::uint16_t* const line =
                    numbers.data() +
                    (within(first_[2] + z, nz) * std::size_t(ny) + within(first_[1] + y, ny)) * std::size_t(nx);
                for (int x = 0; x < row; ++x)
                    numbers_[std::size_t((z * row + y) * row + x)] = line[within(first_[0] + x, nx)];
            }
    }

    /// Calls f(voxel of the field, voxel of the tile, voxel of its middle) for those within the volume.
    template <class Function>
    void each(const Function& f) const {
        const auto [nx, ny, nz] = labels_.dimensions;
        for (int z = 0; z < std::min(edge, nz - first_[2]); ++z)
            for (int y = 0; y < std::min(edge, ny - first_[1]); ++y)
                for (int x = 0; x < std::min(edge, nx - first_[0]); ++x)
                    f((std::size_t(first_[2] + z) * std::size_t(ny) + std::size_t(first_[1] + y)) * std::size_t(nx) +
                          std::size_t(first_[0] + x),
                      std::size_t(((z + halo) * row + y + halo) * row + x + halo),
                      std::size_t((z * edge + y) * edge + x));
    }

    /// The border of the labels for which `is_in` holds; nullptr where there is none: `all` tells which side.
    template <class IsIn>
    const std::vector<float>* border_of(const IsIn& is_in, bool& all) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < inside_.size(); ++i) inside_[i] = is_in(numbers_[i]), count += inside_[i];
        all = count == inside_.size();
        return count == 0 || all ? nullptr : &tile_.distance(inside_);
    }

    void fill_distance() {
        bool all = false;
        const auto* border = border_of([&](std::uint16_t n) { return looks_.shown[n] != 0; }, all);
        auto* const out = reinterpret_cast<std::uint8_t*>(out_.distance.data());
        each([&](std::size_t to, std::size_t, std::size_t i) {
            const float code = border ? LabelCoding::middle + LabelCoding::per_voxel * (*border)[i]
                               : all  ? float(LabelCoding::shown)
                                      : float(LabelCoding::hidden);
            out[to] = std::uint8_t(code + 0.5f);
        });
    }

    /// Σ of the steps between opacities, each within the border of those that are at least as opaque. What is hidden
    /// counts as the least.
    void fill_share() {
        std::array<float, std::size_t(edge) * edge * edge> sum;
        sum.fill(looks_.opacities.front());
        for (std::size_t level = 1; level < looks_.opacities.size(); ++level) {
            const float from = looks_.opacities[level - 1], to = looks_.opacities[level];
            bool all = false;
            const auto* border =
                border_of([&](std::uint16_t n) { return looks_.shown[n] && looks_.opacity[n] >= to; }, all);
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] += (to - from) * (border ? std::clamp(0.5f + (*border)[i], 0.0f, 1.0f) : float(all));
        }
        auto* const out = reinterpret_cast<std::uint8_t*>(out_.share.data());
        each([&](std::size_t to, std::size_t, std::size_t i) { out[to] = byte(sum[i]); });
    }

    /// Classes of what is shown within the tile; a few of too many.
    std::vector<std::uint16_t> classes_here(const std::vector<std::uint16_t>& class_of) const {
        std::vector<std::uint16_t> here;
        std::uint16_t last = 0;
        bool any = false;
        for (const std::uint16_t n : numbers_) {
            if (!looks_.shown[n] || (any && n == last)) continue;
            any = true, last = n;
            if (std::find(here.begin(), here.end(), class_of[n]) == here.end()) here.push_back(class_of[n]);
            if (here.size() > max_tints) break;
        }
        return here;
    }

    std::vector<std::vector<float>> distances_of(const std::vector<std::uint16_t>& here,
                                                 const std::vector<std::uint16_t>& class_of) {
        std::vector<std::vector<float>> distances;
        for (const std::uint16_t one : here) {
            bool all = false;
            distances.push_back(
                *border_of([&](std::uint16_t n) { return looks_.shown[n] && class_of[n] == one; }, all));
        }
        return distances;
    }

    /// What is hidden is by its neighbours' function, as by their tints.
    void fill_transfers() {
        const std::vector<std::uint16_t> here = classes_here(looks_.transfer_of);
        const auto out = [&](std::uint16_t one) {
            return reinterpret_cast<std::uint8_t*>(out_.transfers[one].share.data());
        };
        const std::uint16_t alone = here.empty() ? 0 : here.front();
        if (here.size() < 2) return each([&](std::size_t to, std::size_t, std::size_t) { out(alone)[to] = 255; });
        const std::vector<std::vector<float>> distances = distances_of(here, looks_.transfer_of);
        each([&](std::size_t to, std::size_t, std::size_t i) {
            float nearest = -1e9f, sum = 0;
            for (const auto& distance : distances) nearest = std::max(nearest, distance[i]);
            for (const auto& distance : distances) sum += std::max(1 - (nearest - distance[i]), 0.0f);
            for (std::size_t k = 0; k < here.size(); ++k)
                out(here[k])[to] = byte(std::max(1 - (nearest - distances[k][i]), 0.0f) / sum);
        });
    }

    void fill_tint() {
        const std::vector<std::uint16_t> here = classes_here(looks_.tint_of);
        auto* const out = reinterpret_cast<std::uint32_t*>(out_.tint.data());
        if (here.size() > max_tints) return mean_tints(out);
        if (here.size() < 2) {
            const std::uint32_t all = here.empty() ? 0 : packed(looks_.tints[here[0]]);
            return each([&](std::size_t to, std::size_t, std::size_t) { out[to] = all; });
        }
        const std::vector<std::vector<float>> distances = distances_of(here, looks_.tint_of);
        each([&](std::size_t to, std::size_t, std::size_t i) { out[to] = mixed(here, distances, i); });
    }

    /// By how much farther others lie than the nearest; colours of what has one.
    std::uint32_t mixed(const std::vector<std::uint16_t>& here, const std::vector<std::vector<float>>& distances,
                        std::size_t i) const {
        float nearest = -1e9f, nearest_color = -1e9f;
        for (std::size_t k = 0; k < here.size(); ++k) {
            nearest = std::max(nearest, distances[k][i]);
            if (looks_.tints[here[k]].strength > 0) nearest_color = std::max(nearest_color, distances[k][i]);
        }
        std::array<float, 3> root{};
        float strength = 0, weights = 0, color_weights = 0;
        for (std::size_t k = 0; k < here.size(); ++k) {
            const Tint& tint = looks_.tints[here[k]];
            const float w = std::max(1 - (nearest - distances[k][i]), 0.0f);
            strength += w * tint.strength, weights += w;
            if (tint.strength == 0) continue;
            const float v = std::max(1 - (nearest_color - distances[k][i]), 0.0f);
            for (std::size_t c = 0; c < 3; ++c) root[c] += v * tint.root[c];
            color_weights += v;
        }
        for (float& c : root) c /= std::max(color_weights, 1e-9f);
        return packed(root, strength / weights);
    }

    void mean_tints(std::uint32_t* out) const {
        each([&](std::size_t to, std::size_t from, std::size_t) {
            std::array<float, 3> root{};
            float strength = 0, shown = 0, colors = 0;
            for (int j = 0; j < 27; ++j) {
                const auto at = std::int64_t(from) + ((j / 9 - 1) * row + j / 3 % 3 - 1) * row + j % 3 - 1;
                const std::uint16_t n = numbers_[std::size_t(at)];
                if (!looks_.shown[n]) continue;
                const Tint& tint = looks_.tints[looks_.tint_of[n]];
                shown += 1, strength += tint.strength, colors += tint.strength > 0;
                for (std::size_t c = 0; c < 3; ++c) root[c] += tint.root[c];
            }
            for (float& c : root) c /= std::max(colors, 1.0f);
            out[to] = packed(root, strength / std::max(shown, 1.0f));
        });
    }

    const LabelVolume& labels_;
    const Looks& looks_;
    LabelFields& out_;
    BorderTile tile_;
    const int halo = tile_.halo(), row = tile_.row();
    std::array<int, 3> first_{};
    std::vector<std::uint16_t> numbers_;  ///< row³
    std::vector<std::uint8_t> inside_;
};

}  // namespace

namespace {

/// A byte for each tile of 32³ voxels.
std::vector<std::uint8_t> all_tiles(const LabelFields& fields) {
    return std::vector<std::uint8_t>(std::size_t(fields.tiles[0] * fields.tiles[1] * fields.tiles[2]), 1);
}

void fill(const std::vector<std::uint8_t>& wanted, const LabelVolume& labels, const Looks& looks, LabelFields& fields,
          int threads, const Progress& progress) {
    const auto& tiles = fields.tiles;
    constexpr int grain = 8;  // a thread's tile takes 5 MB, made anew for each piece
    parallel_for(threads, tiles[0] * tiles[1] * tiles[2], grain, [&](std::int64_t first, std::int64_t last) {
        if (std::find(wanted.begin() + first, wanted.begin() + last, 1) == wanted.begin() + last) return;
        Tiles own(labels, looks, fields);
        for (std::int64_t t = first; t < last && !progress.cancelled(); ++t)
            if (wanted[std::size_t(t)])
                own.fill({int(t % tiles[0]) * edge, int(t / tiles[0] % tiles[1]) * edge,
                          int(t / (tiles[0] * tiles[1])) * edge});
    });
    progress.check();
}

/// Those that look at a voxel whose label has another look.
std::vector<std::uint8_t> tiles_of(const std::vector<std::uint8_t>& is_changed, const LabelVolume& labels,
                                   const LabelFields& fields, int threads) {
    std::vector<std::uint8_t> tiles(std::size_t(fields.tiles[0] * fields.tiles[1] * fields.tiles[2]));
    const auto [nx, ny, nz] = labels.dimensions;
    const auto numbers = labels.numbers();
    const int halo = BorderTile::halo_of(border_widths(labels.geometry.spacing_mm));
    parallel_for(threads, std::int64_t(tiles.size()), 1, [&](std::int64_t t, std::int64_t) {
        const std::array<int, 3> n{nx, ny, nz};
        std::array<int, 3> low, high;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at = int((a == 0   ? t
                                 : a == 1 ? t / fields.tiles[0]
                                          : t / (fields.tiles[0] * fields.tiles[1])) %
                                fields.tiles[a]);
            low[a] = std::max(at * edge - halo, 0), high[a] = std::min((at + 1) * edge + halo, n[a]);
        }
        for (int z = low[2]; z < high[2]; ++z)
            for (int y = low[1]; y < high[1]; ++y) {
                const std::uint16_t* const line =
                    &numbers[(std::size_t(z) * std::size_t(ny) + std::size_t(y)) * std::size_t(nx)];
                for (int x = low[0]; x < high[0]; ++x)
                    if (is_changed[line[x]]) return void(tiles[std::size_t(t)] = 1);
            }
    });
    return tiles;
}

/// All but what is said of every voxel by itself.
LabelFields empty_fields(const LabelVolume& labels, const Looks& looks) {
    LabelFields made;
    made.dimensions = labels.dimensions;
    for (std::size_t a = 0; a < 3; ++a) made.tiles[a] = (labels.dimensions[a] + edge - 1) / edge;
    if (!looks.shown[0]) made.distance_beyond = LabelCoding::hidden;
    if (looks.dims) made.share_beyond = byte(looks.shown[0] ? looks.opacity[0] : looks.opacities.front());
    if (looks.shown[0]) made.tint_beyond = packed(looks.tints[looks.tint_of[0]]);
    return made;
}

}  // namespace

LabelFields make_label_fields(const LabelVolume& labels, const std::vector<Label>& of_labels, ColorMode color,
                              int threads, const Progress& progress) {
    const Looks looks(of_labels, color);
    LabelFields made = empty_fields(labels, looks);
    const std::size_t voxels = labels.numbers().size();
    if (looks.hides) made.distance = VoxelBuffer(voxels);
    if (looks.dims) made.share = VoxelBuffer(voxels);
    if (looks.paints) made.tint = VoxelBuffer(4 * voxels);
    if (looks.has_transfers())
        for (const auto& transfer : looks.transfers) made.transfers.push_back({transfer, VoxelBuffer(voxels)});
    if (!looks.hides && !looks.dims && !looks.paints && !looks.has_transfers()) return made;
    fill(all_tiles(made), labels, looks, made, threads, progress);
    return made;
}

std::vector<std::uint8_t> renew_label_fields(LabelFields& fields, const LabelVolume& labels,
                                             const std::vector<Label>& before, const std::vector<Label>& now,
                                             ColorMode color, int threads, const Progress& progress) {
    const Looks old(before, color), looks(now, color);
    const auto in_all = [](const Looks& l) { return std::tie(l.opacities, l.paints, l.transfers); };
    if (in_all(old) != in_all(looks)) {
        fields = make_label_fields(labels, now, color, threads, progress);
        return all_tiles(fields);
    }
    LabelFields renewed = empty_fields(labels, looks);
    renewed.share = std::move(fields.share), renewed.tint = std::move(fields.tint);
    renewed.transfers = std::move(fields.transfers);
    if (looks.hides) {
        renewed.distance = old.hides ? std::move(fields.distance) : VoxelBuffer(labels.numbers().size());
        if (!old.hides) std::memset(renewed.distance.data(), LabelCoding::shown, renewed.distance.size());
    }
    fields = std::move(renewed);
    std::vector<std::uint8_t> is_changed(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) is_changed[i] = !(before[i] == now[i]);
    std::vector<std::uint8_t> tiles = tiles_of(is_changed, labels, fields, threads);
    fill(tiles, labels, looks, fields, threads, progress);
    return tiles;
}

}  // namespace chiaro
