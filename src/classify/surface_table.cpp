#include "classify/surface_table.h"

#include <algorithm>
#include <cmath>

#include "volume/float3.h"

namespace chiaro {
namespace {

/// The number that lies so many octaves above 1, even within each.
double of_octave(double octaves) {
    const double whole = std::floor(octaves);
    return std::exp2(whole) * (1 + octaves - whole);
}

}  // namespace

SurfaceTable::SurfaceTable(const Medium::Data& medium) {
    const Geometry& geometry = medium.volume.geometry();
    const OpticalTable& table = medium.table;
    const double edge = geometry.smallest_spacing_mm();
    opacity_.reserve(table.entries.size());
    for (const auto& entry : table.entries)
        opacity_.push_back(float(-std::expm1(-double(entry.extinction_per_mm) * edge)));
    // A gradient is a covector: its axes in the world are those of the voxels per mm, here per smallest edge.
    const auto row = [&](Vec3 axis) { return float3(edge * geometry.voxel_from_world_vector(axis)); };
    view_ = {.opacity = nullptr,
             .scale = float(table.index_scale),
             .offset = float(table.index_offset + 0.5),
             .last = float(table.entries.size() - 1),
             .edge_mm = float(edge),
             .world_x = row({1, 0, 0}),
             .world_y = row({0, 1, 0}),
             .world_z = row({0, 0, 1})};
}

std::shared_ptr<const SurfaceTable> surface_table_of(const Medium::Data& medium) {
    return medium.surface_table([&] { return std::make_shared<const SurfaceTable>(medium); });
}

ShareTable::ShareTable(const OpticalTable& table, const SurfaceTable& surface) {
    using View = kernel::ShareTableView;
    const double half = 0.5 * double(table.entries.size()), per_stored = table.index_scale / half;
    const double middle = (half - table.index_offset - 0.5) / table.index_scale;
    view_.scale = float(per_stored), view_.offset = float(-middle * per_stored);
    view_.slope_scale = float(per_stored * per_stored);
    const kernel::SurfaceView by_opacity = surface.view();
    // Rays remember the surfaces that they meet: none of less than this, so that blocks of several ranks agree.
    constexpr float least = 0.015f;
    const auto in_bytes = [](float x) { return std::uint8_t(255 * std::min(x, 1.0f) + 0.5f); };
    std::vector<std::uint8_t> share, depth;
    // The places of nodes: what locate() turns into whole numbers.
    const auto way_of = [](int node) {
        const double off = std::abs(node - View::middle) / double(View::per_octave);
        const double far = off < 1 ? off : of_octave(off - 1);
        return node < View::middle ? -far : far;
    };
    for (int octave = 0; octave <= View::octaves; ++octave) {
        const float slope =
            octave > 0 ? float(std::sqrt(of_octave(octave + View::least_octave)) / per_stored) : 0;  // even matter
        for (int i = 0; i < View::values; ++i) {
            const auto found = by_opacity.of_slope(float(middle + way_of(i) / per_stored), slope);
            share.push_back(found.share < least ? 0 : in_bytes(found.share));
            depth.push_back(in_bytes(found.depth / View::deepest));
        }
    }
    const auto quads = [](const std::vector<std::uint8_t>& nodes) {
        std::vector<std::uint32_t> words(std::size_t(View::values) * View::octaves);
        for (std::size_t i = 0; i < words.size(); ++i) {
            const std::size_t next = std::min(i + View::values + 1, nodes.size() - 1);
            words[i] = nodes[i] | nodes[i + 1] << 8 | nodes[i + View::values] << 16 | std::uint32_t(nodes[next]) << 24;
        }
        return words;
    };
    shares_ = quads(share), depths_ = quads(depth);
}

std::shared_ptr<const ShareTable> share_table_of(const Medium::Data& medium) {
    if (is_mixed(medium) || medium.volume.data().factor) return nullptr;
    return medium.share_table(
        [&] { return std::make_shared<const ShareTable>(medium.table, *surface_table_of(medium)); });
}

}  // namespace chiaro
