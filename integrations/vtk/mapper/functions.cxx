#include "look.h"

#include <algorithm>
#include <cmath>

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkVolumeProperty.h"

namespace chiaro::from_vtk {
namespace {

bool is_constant_one(vtkPiecewiseFunction& f) {
    for (int i = 0; i < f.GetSize(); ++i) {
        double node[4];
        f.GetNodeValue(i, node);
        if (node[1] != 1) return false;
    }
    return true;
}

/// Adds what lies between two values until straight lines are near enough; the ends are there.
template <class At>
void add_between(std::vector<ControlPoint>& points, const At& at, const ControlPoint& a, const ControlPoint& b,
                 int halvings) {
    constexpr double near_enough = 1e-3;
    if (halvings == 0) return;
    const auto off = [&](double share) {
        const ControlPoint p = at(a.value + share * (b.value - a.value));
        double most = std::abs(p.opacity - (a.opacity + share * (b.opacity - a.opacity)));
        for (std::size_t c = 0; c < 3; ++c)
            most = std::max(most, std::abs(p.rgb[c] - (a.rgb[c] + share * (b.rgb[c] - a.rgb[c]))));
        return most;
    };
    if (std::max({off(0.25), off(0.5), off(0.75)}) < near_enough) return;
    const ControlPoint middle = at((a.value + b.value) / 2);
    add_between(points, at, a, middle, halvings - 1);
    points.push_back(middle);
    add_between(points, at, middle, b, halvings - 1);
}

}  // namespace

std::vector<GradientPoint> gradient_opacity_of(vtkVolumeProperty& property, int component, double mean_edge_mm) {
    if (!property.HasGradientOpacity(component) || property.GetDisableGradientOpacity(component)) return {};
    vtkPiecewiseFunction& f = *property.GetGradientOpacity(component);
    if (f.GetSize() == 0 || is_constant_one(f)) return {};
    constexpr int pieces = 16;  // of what midpoint and sharpness bend between two nodes
    std::vector<GradientPoint> points;
    const auto add = [&](double magnitude, double opacity) {
        points.push_back({std::max(magnitude, 0.0) / mean_edge_mm, std::clamp(opacity, 0.0, 1.0)});
    };
    for (int i = 0; i < f.GetSize(); ++i) {
        double node[4], next[4];
        f.GetNodeValue(i, node);
        if (i + 1 < f.GetSize()) f.GetNodeValue(i + 1, next);
        if (node[0] >= 0 || i + 1 == f.GetSize()) add(node[0], node[1]);
        for (int k = 1; k < pieces && i + 1 < f.GetSize(); ++k)
            if (const double at = std::lerp(node[0], next[0], k / double(pieces)); at >= 0 && next[0] > node[0])
                add(at, f.GetValue(at));
    }
    return points;
}

TransferFunction transfer_of(vtkVolumeProperty& property, int component, double scale) {
    vtkPiecewiseFunction& opacity = *property.GetScalarOpacity(component);
    const bool is_gray = property.GetColorChannels(component) == 1;
    vtkPiecewiseFunction* gray = is_gray ? property.GetGrayTransferFunction(component) : nullptr;
    vtkColorTransferFunction* colors = is_gray ? nullptr : property.GetRGBTransferFunction(component);
    std::vector<double> values;
    for (int i = 0; i < opacity.GetSize(); ++i) {
        double node[4];
        opacity.GetNodeValue(i, node);
        values.push_back(node[0]);
    }
    for (int i = 0; i < (gray ? gray->GetSize() : colors->GetSize()); ++i) {
        double node[6];
        gray ? gray->GetNodeValue(i, node) : colors->GetNodeValue(i, node);
        values.push_back(node[0]);
    }
    if (values.empty()) values.push_back(0);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());

    const auto at = [&](double value) {
        ControlPoint p{value, {}, std::clamp(opacity.GetValue(value), 0.0, 1.0)};
        if (gray)
            p.rgb.fill(std::clamp(gray->GetValue(value), 0.0, 1.0));
        else {
            double rgb[3];
            colors->GetColor(value, rgb);
            for (std::size_t c = 0; c < 3; ++c) p.rgb[c] = std::clamp(rgb[c], 0.0, 1.0);
        }
        return p;
    };
    // Between nodes from just behind one to just before the next: at a node a function may jump.
    const auto beside = [&](double value, double where) {
        ControlPoint p = at(where);
        p.value = value;
        return p;
    };
    TransferFunction tf;
    const double width = std::max(values.back() - values.front(), 1e-30);
    tf.points.push_back(beside(values.front(), values.front() - width));
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        const double a = values[i], b = values[i + 1], little = 1e-6 * (b - a);
        const ControlPoint first = beside(a, a + little), last = beside(b, b - little);
        tf.points.push_back(first);
        add_between(tf.points, at, first, last, 10);
        tf.points.push_back(last);
    }
    if (values.size() == 1) tf.points.push_back(at(values.front()));
    tf.points.push_back(beside(values.back(), values.back() + width));
    tf.opacity_unit = property.GetScalarOpacityUnitDistance(component) / scale;
    tf.opacity_unit_is_mm = true;
    return tf;
}

TransferFunction transfer_over_gradient(vtkVolumeProperty& property, int component, vtkDataArray& scalars, double scale,
                                        double mean_edge_mm) {
    vtkImageData& image = *property.GetTransferFunction2D(component);
    vtkDataArray& rgba = *image.GetPointData()->GetScalars();
    double range[2];
    scalars.GetFiniteRange(range, component);
    const double width = range[1] > range[0] ? range[1] - range[0] : 1, top = width / 4 / mean_edge_mm;
    int size[3];
    image.GetDimensions(size);
    GradientGrid grid{.columns = size[0], .rows = size[1]};
    // Texels stand at the middle of their share of the axis.
    const double column = 0.5 / size[0], row = 0.5 / size[1];
    grid.value_low = range[0] + column * width, grid.value_high = range[0] + (1 - column) * width;
    grid.magnitude_low = row * top, grid.magnitude_high = (1 - row) * top;
    for (vtkIdType i = 0; i < vtkIdType(size[0]) * size[1]; ++i) {
        auto& to = grid.rgba.emplace_back();
        for (int c = 0; c < 4; ++c) to[std::size_t(c)] = float(std::clamp(rgba.GetComponent(i, c), 0.0, 1.0));
    }
    TransferFunction tf = over_gradient(std::move(grid));
    tf.opacity_unit = property.GetScalarOpacityUnitDistance(component) / scale;
    tf.opacity_unit_is_mm = true;
    return tf;
}

}  // namespace chiaro::from_vtk
