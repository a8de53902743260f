#include "look.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>

#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPointData.h"
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

namespace {

bool shade_differs(vtkVolumeProperty& property, int components) {
    for (int i = 1; i < components; ++i)
        if (property.GetAmbient(i) != property.GetAmbient() || property.GetDiffuse(i) != property.GetDiffuse() ||
            property.GetSpecular(i) != property.GetSpecular() ||
            property.GetSpecularPower(i) != property.GetSpecularPower())
            return true;
    return false;
}

bool is_over_gradient(vtkVolumeProperty& property) {
    return property.GetTransferFunctionMode() == vtkVolumeProperty::TF_2D;
}

/// Of what asks for two values, or has several.
std::string not_drawn_of_several(vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkDataArray& scalars) {
    const int count = scalars.GetNumberOfComponents(), blend = mapper.GetBlendMode();
    if (count > VTK_MAX_VRCOMP) return "scalars of more than four components";
    if (is_dependent(property, count)) {
        if (count == 3) return "three dependent components";
        if (count == 4 && scalars.GetDataType() != VTK_UNSIGNED_CHAR)
            return "four dependent components that are no bytes";
        if (blend != vtkVolumeMapper::COMPOSITE_BLEND) return "blend modes of dependent components";
        if (is_over_gradient(property)) return "TF_2D of dependent components";
    }
    if (count > 1 && blend == vtkVolumeMapper::ISOSURFACE_BLEND) return "ISOSURFACE_BLEND of several components";
    if (count > 1 && property.GetShade() && shade_differs(property, count))
        return "shading that is another for each component";
    for (int i = 0; is_over_gradient(property) && i < count; ++i) {
        vtkImageData* function = property.GetTransferFunction2D(i);
        vtkDataArray* rgba = function ? function->GetPointData()->GetScalars() : nullptr;
        if (!rgba || rgba->GetNumberOfComponents() != 4 || rgba->GetNumberOfTuples() == 0)
            return "TF_2D without an image of four values, red, green, blue, opacity";
    }
    return {};
}

}  // namespace

bool is_dependent(vtkVolumeProperty& property, int components) {
    return components > 1 && !property.GetIndependentComponents();
}

std::string not_drawn(vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
                      vtkDataArray& scalars) {
    if (!type_of(scalars)) return "scalars of bits";
    if (image.HasAnyBlankPoints() || image.HasAnyBlankCells()) return "blanked points or cells";
    if (property.HasLabelGradientOpacity()) return "transfer functions of labels";
    if (property.GetInterpolationType() != VTK_LINEAR_INTERPOLATION)
        return "interpolation of nearest voxels; SetInterpolationTypeToLinear()";
    if (property.GetUseClippedVoxelIntensity()) return "UseClippedVoxelIntensity";
    if (std::string what = not_drawn_of_several(mapper, property, scalars); !what.empty()) return what;
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

namespace {

/// Functions of values: the volume's own, or one for each of its channels.
void set_functions(Scene& scene, vtkVolumeProperty& property, vtkDataArray* scalars, const Placement& place) {
    const Vec3& edges = place.geometry.spacing_mm;
    const double mean_edge = (edges.x + edges.y + edges.z) / 3;
    const int count = scalars ? scalars->GetNumberOfComponents() : 1;
    const auto function_of = [&](int component) {
        TransferFunction tf = scalars && is_over_gradient(property)
                                  ? transfer_over_gradient(property, component, *scalars, place.scale, mean_edge)
                                  : transfer_of(property, component, place.scale);
        tf.gradient = gradient_opacity_of(property, component, mean_edge);
        return tf;
    };
    const bool dependent = is_dependent(property, count);
    if (count == 1 || (dependent && count == 4)) {
        scene.transfer.points = function_of(0);
        return;
    }
    for (int i = 0; i < count; ++i) {
        ChannelSettings& channel = scene.channels.emplace_back();
        channel.transfer.points = function_of(dependent ? 0 : i);
        if (!dependent) channel.gain = property.GetComponentWeight(i);
    }
    if (dependent) scene.channels[1].transfer.points->gradient.clear();  // of colours
}

}  // namespace

void set_look(Scene& scene, vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
              vtkDataArray* scalars, vtkRenderer& renderer, const Placement& place, std::string& note) {
    set_functions(scene, property, scalars, place);
    scene.interpolation = Interpolation::linear;  // as the property says
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
    set_lights(lighting, renderer, place, note);
}

void suit_blocks(Scene& scene) {
    if (!scene.transfer.points)
        throw Error(ErrorCode::usage, "a scene that several processes draw must state its transfer function's points");
    if (scene.interpolation == Interpolation::automatic) scene.interpolation = Interpolation::linear;
    if (!scene.camera.fit_centre) scene.camera.fit = Fit::volume;
}

}  // namespace chiaro::from_vtk
