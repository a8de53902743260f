#include "illumination/access.h"

#include "illumination/reference/reference.h"
#include "illumination/spao/spao.h"

namespace chiaro {
namespace {

/// Any normal that can be told from noise decides.
constexpr double at_once = 10;

}  // namespace

CellValues accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                         const IlluminationSettings& settings, const BlockMap& blocks, StageTimer& timer,
                         Progress& progress) {
    if (settings.method == Method::spao)
        return spao_accessibility(device, opacity, settings.spao, blocks, timer, progress);
    return reference_accessibility(device, medium, opacity, settings.reference, blocks, timer, progress);
}

double outward_factor(const IlluminationSettings& settings) {
    constexpr auto obscurance = ReferenceQuantity::obscurance;
    if (settings.method == Method::reference)
        return settings.reference.quantity.value_or(obscurance) == obscurance ? 0 : reference_normal_factor;
    if (settings.spao.model == SpaoModel::corrected) return settings.spao.normal_factor;
    return settings.spao.normal_factor == 0 ? 0 : at_once;  // the published cubes move outwards as a whole
}

}  // namespace chiaro
