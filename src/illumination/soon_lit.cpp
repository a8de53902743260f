#include "illumination/soon_lit.h"

#include "illumination/field.h"

namespace chiaro {
namespace {

/// Voxels from which on light takes longer than drafts may. (512³ on two cores: light .3 s, of every other voxel .06;
/// 256³: .06 s.)
constexpr double large = 220.0 * 220 * 220;

}  // namespace

bool is_large(const DeviceVolume& volume) {
    const DeviceVolume::Data& data = volume.data();
    const auto [nx, ny, nz] = data.dimensions;
    const bool is_plain = !data.placement && !data.pages && !data.mixture && !data.plain;
    return is_plain && !data.device.has_gpu() && double(nx) * ny * nz >= large;
}

bool is_soon_lit(const DeviceVolume& volume, const IlluminationSettings& settings) {
    return settings.method == Method::spao && is_large(volume);
}

IlluminationField light_of_every_other_voxel(const Device& device, const Medium& every_other, const Lighting& lighting,
                                             IlluminationSettings settings, Progress& progress) {
    settings.spao.levels = std::max(settings.spao.levels - 1, 1);  // cubes as wide as before
    IlluminationField found;
    const auto keep = [&](IlluminationField field) { found = std::move(field); };
    illuminate(device, every_other, Prepared(), lighting, settings, keep, progress);
    progress.check();
    return found;
}

IlluminationField spread_out(const IlluminationField& field) {
    if (!std::holds_alternative<kernel::AccessView>(field.data().view)) return field;  // of a mode that shows no light
    kernel::AccessView view = std::get<kernel::AccessView>(field.data().view);
    kernel::Float3& nodes = view.grid.nodes_per_voxel;
    nodes = {nodes.x / 2, nodes.y / 2, nodes.z / 2};
    view.off_surface.to_level({0.5f, 0.5f, 0.5f});
    auto data = std::make_shared<IlluminationField::Data>();
    data->view = view, data->access = field.data().access;
    data->surfaces = field.data().surfaces;
    data->is_coarse = true;
    data->stages = field.stages();
    return IlluminationField(std::move(data));
}

}  // namespace chiaro
