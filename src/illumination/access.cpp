#include "illumination/access.h"

#include "illumination/cells/surface_share.h"
#include "illumination/reference/reference.h"
#include "illumination/spao/spao.h"

namespace chiaro {
namespace {

/// Any normal that can be told from noise decides.
constexpr double at_once = 10;

/// F: how soon a normal makes the answer look outwards only; 0 when it never does.
double outward_factor(const IlluminationSettings& settings) {
    constexpr auto obscurance = ReferenceQuantity::obscurance;
    if (settings.method == Method::reference)
        return settings.reference.quantity.value_or(obscurance) == obscurance ? 0 : reference_normal_factor;
    if (settings.spao.model == SpaoModel::corrected) return settings.spao.normal_factor;
    return settings.spao.normal_factor == 0 ? 0 : at_once;  // the published cubes move outwards as a whole
}

/// Shells take what they hold to be blocked each on its own, though one wall blocks all: over open planes that lie
/// aslant of the grid x is .77 to .9. With x (.85 + .7 x) these are open, and .4 stays .45. (Tuned as access_lift is.)
constexpr float gain_of_shells = 0.85f, more_of_shells = 0.7f;

}  // namespace

kernel::SurfaceAccess surface_access(const IlluminationSettings& settings, double cell_edges) {
    const bool is_of_shells = settings.method == Method::spao && settings.spao.model == SpaoModel::corrected;
    return {float(access_lift * cell_edges), is_of_shells ? gain_of_shells : 1, is_of_shells ? more_of_shells : 0};
}

CellValues accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                         const IlluminationSettings& settings, const BlockMap& blocks, StageTimer& timer,
                         Progress& progress, bool of_surfaces) {
    const bool is_spao = settings.method == Method::spao;
    if (is_spao && is_fused(settings.spao))
        return spao_accessibility(device, opacity, settings.spao, blocks, timer, progress, of_surfaces);
    CellValues access =
        is_spao ? spao_accessibility(device, opacity, settings.spao, blocks, timer, progress)
                : reference_accessibility(device, medium, opacity, settings.reference, blocks, timer, progress);
    if (!of_surfaces) return access;
    return timer("surfaces", [&] {
        return surface_shares(device, std::move(access), opacity.values, outward_factor(settings), blocks, progress);
    });
}

}  // namespace chiaro
