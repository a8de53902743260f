// What stands behind an IlluminationField: one row per kind of answer.
#pragma once
#include <chiaro/lighting.h>

#include <memory>
#include <variant>

#include "illumination/cells/field.h"
#include "illumination/cells/grid.h"
#include "illumination/histogram/light.h"
#include "illumination/none/field.h"

namespace chiaro {

struct IlluminationField::Data {
    /// The view that the ray caster looks up. A new kind of light: its folder, and its view here.
    std::variant<kernel::NoneView, kernel::AccessView, kernel::HistogramView> view;
    std::shared_ptr<const CellValues> access;         ///< what an AccessView reads
    std::shared_ptr<const HistogramLight> histogram;  ///< what a HistogramView reads
    std::vector<Stage> stages;
};

}  // namespace chiaro
