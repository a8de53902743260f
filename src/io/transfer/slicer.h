// What the two kinds of 3D Slicer's volume properties have in common.
#pragma once
#include <string>

#include "io/transfer/curve.h"
#include "io/transfer/reader.h"

namespace chiaro {

struct SlicerShading {
    double ambient, diffuse, specular, power;
};

/// Colours and opacities over values in data units, opacity over millimetres.
FoundFunction slicer_function(const ColorCurve& color, const OpacityCurve& opacity, double unit_mm);

/// Says what would give the file's shading, which is no part of a transfer function.
std::string note_on_shading(const SlicerShading& shading);

/// Takes the gradient opacity over, unless it is 1 throughout.
void take_gradient_opacity(const OpacityCurve& gradient, FoundFunction& found);

}  // namespace chiaro
