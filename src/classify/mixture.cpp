#include "classify/mixture.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "classify/labels/labelled.h"
#include "kernel/rgba.h"
#include "volume/borrowed.h"
#include "volume/device_view.h"
#include "volume/label_bricks.h"

namespace chiaro {
namespace {

using Channels = std::vector<std::shared_ptr<const Medium::Data>>;

template <class T>
int compared(const T* a, std::size_t a_count, const T* b, std::size_t b_count) {
    if (a_count != b_count) return a_count < b_count ? -1 : 1;
    return a_count ? std::memcmp(a, b, a_count * sizeof(T)) : 0;
}

/// An order that does not depend on the one they came in: by look, then by voxels.
bool comes_before(const std::shared_ptr<const Medium::Data>& a, const std::shared_ptr<const Medium::Data>& b) {
    const auto &s = a->table.entries, &t = b->table.entries;
    if (const int looks = compared(s.data(), s.size(), t.data(), t.size())) return looks < 0;
    const DeviceVolume::Data &v = a->volume.data(), &w = b->volume.data();
    if (v.scale != w.scale || v.offset != w.offset) return std::pair(v.scale, v.offset) < std::pair(w.scale, w.offset);
    if (v.factor && w.factor) {
        const auto &f = v.factor->entries, &g = w.factor->entries;
        if (const int factors = compared(f.data(), f.size(), g.data(), g.size())) return factors < 0;
        const auto &c = v.factor->colors, &d = w.factor->colors;
        if (const int colors = compared(c.data(), c.size(), d.data(), d.size())) return colors < 0;
    }
    return compared(v.bricks.data(), v.bricks.size(), w.bricks.data(), w.bricks.size()) < 0;
}

void check_alike(const Channels& channels) {
    if (channels.size() > max_channels)
        throw Error(ErrorCode::usage,
                    fmt::format("at most {} channels can be shown at a time, not {}", max_channels, channels.size()));
    const DeviceVolume::Data& first = channels.front()->volume.data();
    for (const auto& channel : channels) {
        const DeviceVolume::Data& volume = channel->volume.data();
        if (volume.dimensions != first.dimensions || volume.stored != first.stored)
            throw Error(ErrorCode::internal, "channels of one medium need one grid and one stored type");
        if (volume.pages) throw Error(ErrorCode::usage, "channels are not read by bricks: raise --memory");
    }
}

/// dκ/dv per stored unit, over a 64th of the table on the side where it changes more, so that a table may jump; and a
/// thousandth of κ.
std::vector<float> rises_of(const OpticalTable& table) {
    constexpr std::size_t width = 64;
    constexpr double even = 1e-3;
    const auto& entries = table.entries;
    std::vector<float> rises;
    for (std::size_t j = 0; j < entries.size(); ++j) {
        const double here = entries[j].extinction_per_mm;
        const double above = entries[std::min(j + width, entries.size() - 1)].extinction_per_mm - here,
                     below = here - entries[j > width ? j - width : 0].extinction_per_mm;
        const double rise = std::abs(above) < std::abs(below) ? below : above;
        rises.push_back(float((rise + even * here) / double(width) * table.index_scale));
    }
    return rises;
}

/// By the entries of a factor that has colours; empty: colours are those of the values.
std::vector<kernel::Rgba> colors_by_gradient(const ExtinctionFactor* factor) {
    std::vector<kernel::Rgba> entries;
    if (!factor) return entries;
    for (std::size_t i = 0; i < factor->colors.size(); ++i) {
        const auto& [r, g, b] = factor->colors[i];
        const float left = factor->entries[i];
        entries.push_back({left * r, left * g, left * b, left});
    }
    return entries;
}

const std::uint8_t* share_of(const VoxelBuffer* share) {
    return share ? reinterpret_cast<const std::uint8_t*>(share->data()) : nullptr;
}

/// What kernels read of channels; it keeps them.
template <class Voxel>
struct ViewsOfChannels {
    Channels channels;
    std::vector<std::vector<kernel::Rgba>> matter, by_gradient;
    std::vector<std::vector<float>> rises;
    std::vector<kernel::ChannelView<Voxel>> views;

    explicit ViewsOfChannels(const MixtureParts& of) : channels(of.channels) {
        for (const auto& channel : channels) {
            const bool is_color = of.own_colors && channel != channels.front();
            const OpticalTable& table = channel->table;
            rises.push_back(is_color ? std::vector<float>(table.entries.size()) : rises_of(table));
            auto& entries = matter.emplace_back();
            for (const OpticalTable::Entry& e : table.entries) {
                const float kappa = is_color ? 0 : e.extinction_per_mm;
                const float weight = is_color ? 1 : of.own_colors ? 0 : kappa;
                entries.push_back({weight * e.r, weight * e.g, weight * e.b, kappa});
            }
        }
        for (const auto& channel : channels)
            by_gradient.push_back(of.own_colors ? std::vector<kernel::Rgba>()
                                                : colors_by_gradient(channel->volume.data().factor.get()));
        for (std::size_t i = 0; i < channels.size(); ++i) {
            const OpticalTable& table = channels[i]->table;
            views.push_back({view_of<Voxel>(channels[i]->volume.data()),
                             {matter[i].data(), float(table.index_scale), float(table.index_offset + 0.5),
                              float(matter[i].size() - 1)},
                             rises[i].data(),
                             share_of(channels[i]->share.get()),
                             by_gradient[i].empty() ? nullptr : by_gradient[i].data()});
        }
    }
};

std::shared_ptr<const MixtureOfChannels> mixture_of(const MixtureParts& parts) {
    auto mixture = std::make_shared<MixtureOfChannels>();
    mixture->count = int(parts.channels.size());
    mixture->labels = parts.labels, mixture->own_colors = parts.own_colors;
    with_stored_voxel(parts.channels.front()->volume.data(), [&](auto voxel) {
        const auto views = std::make_shared<const ViewsOfChannels<decltype(voxel)>>(parts);
        mixture->channel_views = {views, views->views.data()};
    });
    return mixture;
}

/// The first channel's, looked at as a mixture.
DeviceVolume volume_of(const MixtureParts& parts) {
    auto made = borrowed(parts.channels.front()->volume);
    made->mixture = mixture_of(parts);
    return DeviceVolume(std::move(made));
}

bool is_labelled_channel(const Channels& channels, const LabelBricks* labels, bool own_colors) {
    return labels && channels.size() == 1 && !own_colors && !channels.front()->share;
}

/// Codes of cells, where those of other tints are of other kinds: a ray learns a cube's tint when it enters it.
std::vector<std::uint8_t> cells_by_tint(const std::array<int, 3>& count, const std::vector<std::uint8_t>& occupied,
                                        const LabelBricks& labels, const Progress& progress) {
    constexpr std::uint32_t empty = ~0u;
    std::vector<std::uint32_t> kinds = labels.cells;
    for (std::size_t c = 0; c < kinds.size(); ++c)
        if (!occupied[c]) kinds[c] = empty;
    return make_occupancy(count, std::move(kinds), empty, progress);
}

}  // namespace

bool is_labelled_channel(const Medium::Data& medium) {
    if (!is_mixed(medium)) return false;
    const MixtureOfChannels& mixture = *medium.volume.data().mixture;
    return is_labelled_channel(medium.channels, mixture.labels.get(), mixture.own_colors);
}

std::shared_ptr<const Medium::Data> with_share(const Medium::Data& medium, std::shared_ptr<const VoxelBuffer> share) {
    auto data = std::make_shared<Medium::Data>();
    data->volume = medium.volume, data->table = medium.table, data->shape = medium.shape;
    data->cells = medium.cells, data->occupied_fraction = medium.occupied_fraction;
    data->share = std::move(share);
    return data;
}

MixtureParts parts_of(const Medium::Data& medium) {
    if (!is_mixed(medium)) return {{medium.shared_from_this()}, nullptr};
    const MixtureOfChannels& mixture = *medium.volume.data().mixture;
    return {medium.channels, mixture.labels, mixture.own_colors};
}

Medium mixed(const Device& device, MixtureParts parts, const Shape& shape, const Progress& progress) {
    Channels& channels = parts.channels;
    check_alike(channels);
    if (channels.front()->volume.data().placement)
        throw Error(ErrorCode::usage,
                    "a volume that several ranks share has one channel, colours by value, and no labels");
    if (!parts.own_colors) std::stable_sort(channels.begin(), channels.end(), comes_before);
    auto data = std::make_shared<Medium::Data>();
    std::vector<std::uint8_t> labelled;
    if (parts.labels) labelled = cells_with_labels(*parts.labels, channels.front()->volume.data());
    data->volume = volume_of(parts);
    data->table = channels.front()->table;
    data->shape = shape;
    std::vector<std::uint8_t> occupied(channels.front()->cell_count());
    for (const auto& channel : channels)
        for (std::size_t c = 0; c < occupied.size(); ++c) occupied[c] |= channel->cells[c] & 1;
    for (std::size_t c = 0; c < labelled.size(); ++c) occupied[c] &= labelled[c];
    data->occupied_fraction =
        double(std::count(occupied.begin(), occupied.end(), 1)) / double(std::max<std::size_t>(occupied.size(), 1));
    const CellRanges& cells = data->volume.data().cells;
    const auto any = [](float, float) { return true; };
    data->cells = is_labelled_channel(channels, parts.labels.get(), parts.own_colors)
                      ? cells_by_tint(cells.count, occupied, *parts.labels, progress)
                      : make_occupancy(cells, any, device.threads, progress, occupied);
    data->channels = std::move(channels);
    return Medium(std::move(data));
}

}  // namespace chiaro
