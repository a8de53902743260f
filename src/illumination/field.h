// What stands behind an IlluminationField: one row per method.
#pragma once
#include <chiaro/lighting.h>

#include <variant>

#include "illumination/none/field.h"

namespace chiaro {

struct IlluminationField::Data {
    /// The view that the ray caster looks up. A new method: its folder, and its view here.
    std::variant<kernel::NoneView> view;
};

}  // namespace chiaro
