#include "illumination/transport/scattering_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/srgb.h"

namespace chiaro {
namespace {

ScatteringColour capped(float weight, std::array<float, 3> colour, double albedo_max) {
    const float most = std::max({colour[0], colour[1], colour[2]});
    const float factor = most > albedo_max ? float(albedo_max / most) : 1.0f;
    ScatteringColour tint{.weight = weight};
    for (std::size_t c = 0; c < 3; ++c) tint.colour[c] = colour[c] * (factor * weight);
    return tint;
}

std::array<float, 3> colour_of(const OpticalTable::Entry& entry) { return {entry.r, entry.g, entry.b}; }

std::array<float, 3> colour_of(const Medium::Data& medium, const IsoSurface& surface, double stored) {
    if (!surface.color) return colour_of(medium.table.at(stored));
    std::array<float, 3> colour;
    for (int c = 0; c < 3; ++c) {
        const double picked = (*surface.color)[c];
        colour[c] = float(medium.shape.color == ColorMode::linear ? linear_from_srgb(picked) : picked);
    }
    return colour;
}

}  // namespace

ScatteringColours::ScatteringColours(const Medium::Data& medium, double albedo_max)
    : scale_(float(medium.table.index_scale)),
      offset_(float(medium.table.index_offset + 0.5)),
      last_(float(medium.table.entries.size() - 1)),
      most_(float(albedo_max)) {
    const auto add_all = [&](const Medium::Data& channel) {
        for (const OpticalTable::Entry& entry : channel.table.entries)
            entries_.push_back(capped(entry.extinction_per_mm, colour_of(entry), albedo_max));
    };
    for_each_channel(medium, add_all);
    if (medium.shape.mode != Mode::iso) return;
    const DeviceVolume::Data& volume = medium.volume.data();
    for (std::size_t j = 0; j < entries_.size(); ++j) {
        const double stored = (double(j) - medium.table.index_offset) / medium.table.index_scale;
        const auto off = [&](const IsoSurface& s) {
            return std::abs((s.value - volume.offset) / volume.scale - stored);
        };
        const auto nearest = std::min_element(medium.shape.iso.begin(), medium.shape.iso.end(),
                                              [&](const auto& a, const auto& b) { return off(a) < off(b); });
        const double at = (nearest->value - volume.offset) / volume.scale;
        entries_[j] = capped(1, colour_of(medium, *nearest, at), medium.surface_labels ? 1 : albedo_max);
    }
}

ScatteringColour ScatteringColours::mean() const {
    ScatteringColour sum;
    for (const ScatteringColour& tint : entries_) sum.add(tint);
    if (!(sum.weight > 0)) sum.weight = 1;
    return sum;
}

}  // namespace chiaro
