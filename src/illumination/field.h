// What stands behind an IlluminationField: one row per kind of answer.
#pragma once
#include <chiaro/lighting.h>

#include <memory>
#include <variant>

#include "illumination/cells/field.h"
#include "illumination/cells/grid.h"
#include "illumination/floor/floor_light.h"
#include "illumination/histogram/light.h"
#include "illumination/none/field.h"
#include "illumination/transport/light.h"
#include "illumination/transport/transport.h"
#include "illumination/visibility/field.h"
#include "illumination/visibility/lit_nodes.h"

namespace chiaro {

/// What the ray caster looks up. A new kind of light: its folder, and its view here.
using FieldView = std::variant<kernel::NoneView, kernel::AccessView, kernel::VisibilityView, kernel::HistogramView>;

struct IlluminationField::Data {
    FieldView view;
    std::shared_ptr<const CellValues> access;         ///< what an AccessView reads
    std::shared_ptr<const LitNodes> visibility;       ///< what a VisibilityView is made from, once the light is known
    std::optional<VisibilitySettings> of_visibility;  ///< how that was found
    std::shared_ptr<const HistogramLight> histogram;  ///< what a HistogramView reads
    std::shared_ptr<const TransportLight> transport;  ///< what a VisibilityView is made from, of scattered light
    std::shared_ptr<TransportMemory> memory;          ///< what further transport starts from
    std::optional<double> albedo_limit;               ///< of the colours that light was scattered by
    bool surfaces = true;                             ///< matter shows surfaces
    bool is_coarse = false;
    FloorLight floor;  ///< on a floor under the medium, found when a picture asks
    std::vector<Stage> stages;
};

}  // namespace chiaro
