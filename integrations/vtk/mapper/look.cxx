#include "look.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>

#include "vtkColorTransferFunction.h"
#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkRenderer.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

namespace chiaro::from_vtk {
namespace {

/// Of 27 regions those that are kept as ranges of thirds of each axis, where they are one box.
struct Thirds {
    std::array<int, 3> first{3, 3, 3}, last{-1, -1, -1};
    bool is_box = false;
};
Thirds thirds_of(int flags) {
    Thirds found;
    int count = 0;
    for (int region = 0; region < 27; ++region) {
        if (!(flags >> region & 1)) continue;
        ++count;
        const int at[3]{region % 3, region / 3 % 3, region / 9};
        for (std::size_t a = 0; a < 3; ++a)
            found.first[a] = std::min(found.first[a], at[a]), found.last[a] = std::max(found.last[a], at[a]);
    }
    int inside = 1;
    for (std::size_t a = 0; a < 3; ++a) inside *= found.last[a] - found.first[a] + 1;
    found.is_box = count > 0 && inside == count;
    return found;
}

/// In shares of the voxels' span along each axis.
std::array<double, 6> box_of(vtkVolumeMapper& mapper, vtkImageData& image) {
    const Thirds thirds = thirds_of(mapper.GetCroppingRegionFlags());
    const double* planes = mapper.GetCroppingRegionPlanes();
    double origin[3], spacing[3];
    int extent[6];
    image.GetOrigin(origin), image.GetSpacing(spacing), image.GetExtent(extent);
    std::array<double, 6> box{0, 1, 0, 1, 0, 1};
    for (std::size_t a = 0; a < 3; ++a) {
        const double span = extent[2 * a + 1] - extent[2 * a];
        const auto share = [&](double plane) {
            return span > 0 ? std::clamp(((plane - origin[a]) / spacing[a] - extent[2 * a]) / span, 0.0, 1.0) : 0.0;
        };
        if (span > 0 && thirds.first[a] > 0) box[2 * a] = share(planes[2 * a + std::size_t(thirds.first[a]) - 1]);
        if (span > 0 && thirds.last[a] < 2) box[2 * a + 1] = share(planes[2 * a + std::size_t(thirds.last[a])]);
    }
    return box;
}

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

struct Arrow {
    Vec3 from, to;
};
/// A light's position and focal point in the world.
Arrow arrow_of(vtkLight& light) {
    double from[3], to[3];
    light.GetTransformedPosition(from), light.GetTransformedFocalPoint(to);
    return {{from[0], from[1], from[2]}, {to[0], to[1], to[2]}};
}

/// Of a vector of the world, in the volume's own space but for its length.
Vec3 turned_back(const Placement& place, Vec3 v) {
    const auto& m = place.world_from_volume;
    const auto along = [&](std::size_t c) { return m[c] * v.x + m[4 + c] * v.y + m[8 + c] * v.z; };
    return {along(0), along(1), along(2)};
}

void set_light(Lighting& lighting, vtkRenderer& renderer, const Placement& place, std::string& note) {
    vtkLight* brightest = nullptr;
    int lit = 0;
    vtkCollectionSimpleIterator at;
    vtkLightCollection* lights = renderer.GetLights();
    lights->InitTraversal(at);
    while (vtkLight* light = lights->GetNextLight(at)) {
        if (!light->GetSwitch() || !(light->GetIntensity() > 0)) continue;
        ++lit;
        if (!brightest || light->GetIntensity() > brightest->GetIntensity()) brightest = light;
    }
    if (!brightest) return;
    if (lit > 1) note = "more than one light: the brightest shines alone";
    if (brightest->GetPositional()) note = "positional lights: one shines from its position as from far away";
    const double* rgb = brightest->GetDiffuseColor();
    for (std::size_t c = 0; c < 3; ++c) lighting.color[c] = std::clamp(rgb[c] * brightest->GetIntensity(), 0.0, 1.0);
    if (brightest->LightTypeIsHeadlight()) return;
    const auto [from, to] = arrow_of(*brightest);
    const Vec3 towards = normalized(turned_back(place, from - to));
    lighting.headlight = false;
    lighting.azimuth_deg = std::atan2(towards.y, towards.x) / radians(1);
    lighting.elevation_deg = std::asin(std::clamp(towards.z, -1.0, 1.0)) / radians(1);
}

void set_clip(Clip& clip, vtkVolumeMapper& mapper, vtkImageData& image, const Placement& place) {
    if (mapper.GetCropping()) clip.box = box_of(mapper, image);
    for (int i = 0; i < mapper.GetNumberOfClippingPlanes(); ++i) {
        vtkPlane* plane = mapper.GetClippingPlanes()->GetItem(i);
        double normal[3], origin[3];
        plane->GetNormal(normal), plane->GetOrigin(origin);
        // World x = M p + t: n · (x - o) = (Mᵀ n) · p - n · (o - t). VTK keeps what n points to.
        const auto& m = place.world_from_volume;
        const Vec3 n{normal[0], normal[1], normal[2]}, kept = turned_back(place, n);
        const double d = dot(n, {origin[0] - m[3], origin[1] - m[7], origin[2] - m[11]});
        clip.planes.push_back({-kept, -d});
    }
}

Mode mode_of(int blend) {
    switch (blend) {
        case vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND:
            return Mode::mip;
        case vtkVolumeMapper::MINIMUM_INTENSITY_BLEND:
            return Mode::minip;
        case vtkVolumeMapper::AVERAGE_INTENSITY_BLEND:
            return Mode::mean;
        case vtkVolumeMapper::ADDITIVE_BLEND:
            return Mode::additive;
        case vtkVolumeMapper::ISOSURFACE_BLEND:
            return Mode::iso;
        default:
            return Mode::dvr;
    }
}

}  // namespace

std::string not_drawn(vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
                      vtkDataArray& scalars) {
    if (scalars.GetNumberOfComponents() > 1) return "scalars of more than one component";
    if (!type_of(scalars)) return "scalars of bits";
    if (image.HasAnyBlankPoints() || image.HasAnyBlankCells()) return "blanked points or cells";
    if (property.GetTransferFunctionMode() == vtkVolumeProperty::TF_2D)
        return "TF_2D, transfer functions of two values";
    if (property.HasLabelGradientOpacity()) return "transfer functions of labels";
    if (property.GetInterpolationType() != VTK_LINEAR_INTERPOLATION)
        return "interpolation of nearest voxels; SetInterpolationTypeToLinear()";
    if (property.GetUseClippedVoxelIntensity()) return "UseClippedVoxelIntensity";
    const int blend = mapper.GetBlendMode();
    if (blend == vtkVolumeMapper::SLICE_BLEND) return "SLICE_BLEND";
    const double* range = mapper.GetAverageIPScalarRange();
    if (blend == vtkVolumeMapper::AVERAGE_INTENSITY_BLEND && (range[0] > VTK_FLOAT_MIN || range[1] < VTK_FLOAT_MAX))
        return "AverageIPScalarRange";
    const int values = property.GetIsoSurfaceValues()->GetNumberOfContours();
    if (blend == vtkVolumeMapper::ISOSURFACE_BLEND && (values < 1 || values > max_isosurfaces))
        return "ISOSURFACE_BLEND of no or more than eight values";
    if (mapper.GetCropping() && !thirds_of(mapper.GetCroppingRegionFlags()).is_box)
        return "cropping regions that are not one box";
    if (mapper.GetNumberOfClippingPlanes() > max_clip_planes) return "more than six clipping planes";
    return {};
}

std::vector<GradientPoint> gradient_opacity_of(vtkVolumeProperty& property, double mean_edge_mm) {
    if (!property.HasGradientOpacity() || property.GetDisableGradientOpacity()) return {};
    vtkPiecewiseFunction& f = *property.GetGradientOpacity();
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

TransferFunction transfer_of(vtkVolumeProperty& property, double scale) {
    vtkPiecewiseFunction& opacity = *property.GetScalarOpacity();
    const bool is_gray = property.GetColorChannels() == 1;
    std::vector<double> values;
    for (int i = 0; i < opacity.GetSize(); ++i) {
        double node[4];
        opacity.GetNodeValue(i, node);
        values.push_back(node[0]);
    }
    const int colours =
        is_gray ? property.GetGrayTransferFunction()->GetSize() : property.GetRGBTransferFunction()->GetSize();
    for (int i = 0; i < colours; ++i) {
        double node[6];
        if (is_gray)
            property.GetGrayTransferFunction()->GetNodeValue(i, node);
        else
            property.GetRGBTransferFunction()->GetNodeValue(i, node);
        values.push_back(node[0]);
    }
    if (values.empty()) values.push_back(0);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());

    const auto at = [&](double value) {
        ControlPoint p{value, {}, std::clamp(opacity.GetValue(value), 0.0, 1.0)};
        if (is_gray)
            p.rgb.fill(std::clamp(property.GetGrayTransferFunction()->GetValue(value), 0.0, 1.0));
        else {
            double rgb[3];
            property.GetRGBTransferFunction()->GetColor(value, rgb);
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
    tf.opacity_unit = property.GetScalarOpacityUnitDistance() / scale;
    tf.opacity_unit_is_mm = true;
    return tf;
}

void set_look(Scene& scene, vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
              vtkRenderer& renderer, const Placement& place, std::string& note) {
    scene.transfer.points = transfer_of(property, place.scale);
    const Vec3& edges = place.geometry.spacing_mm;
    scene.transfer.points->gradient = gradient_opacity_of(property, (edges.x + edges.y + edges.z) / 3);
    scene.mode = mode_of(mapper.GetBlendMode());
    if (scene.mode == Mode::iso)
        for (int i = 0; i < property.GetIsoSurfaceValues()->GetNumberOfContours(); ++i) {
            const double value = property.GetIsoSurfaceValues()->GetValue(i);
            scene.iso.push_back({value, {}, std::clamp(property.GetScalarOpacity()->GetValue(value), 0.0, 1.0)});
        }
    set_clip(scene.clip, mapper, image, place);
    Lighting& lighting = scene.lighting;
    lighting.shading = property.GetShade() ? Shading::phong : Shading::none;
    lighting.ambient = property.GetAmbient(), lighting.diffuse = property.GetDiffuse();
    lighting.specular = property.GetSpecular(), lighting.shininess = property.GetSpecularPower();
    set_light(lighting, renderer, place, note);
}

void suit_blocks(Scene& scene) {
    if (!scene.transfer.points)
        throw Error(ErrorCode::usage, "a scene that several processes draw must state its transfer function's points");
    if (scene.interpolation == Interpolation::automatic) scene.interpolation = Interpolation::linear;
    if (!scene.camera.fit_centre) scene.camera.fit = Fit::volume;
}

}  // namespace chiaro::from_vtk
