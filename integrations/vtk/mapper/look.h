// From what VTK says of a look to Chiaro's settings.
#pragma once
#include <chiaro/scene.h>

#include <string>

#include "data.h"

class vtkRenderer;
class vtkVolumeMapper;
class vtkVolumeProperty;

namespace chiaro::from_vtk {

/// The first thing asked for, by its name in VTK, that is not drawn; empty: all of it is.
std::string not_drawn(vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image, vtkDataArray& scalars);

/// Whether the values of a voxel say together what it looks like: colours and opacity.
bool is_dependent(vtkVolumeProperty& property, int components);

/// A component's colour and opacity over values, with the unit distance in the volume's own space: piecewise linear to
/// 1/1000.
TransferFunction transfer_of(vtkVolumeProperty& property, int component, double scale);

/// TF_2D: an image that spans the component's range of values and, in values over a mean voxel edge, a quarter of it.
TransferFunction transfer_over_gradient(vtkVolumeProperty& property, int component, vtkDataArray& scalars, double scale,
                                        double mean_edge_mm);

/// Opacity by gradient, per mm: VTK's gradients are of the values over a mean voxel edge. Empty: none.
std::vector<GradientPoint> gradient_opacity_of(vtkVolumeProperty& property, int component, double mean_edge_mm);

/// The renderer's lights, in the volume's own space; one that has none yet is about to make a headlight.
void set_lights(Lighting& lighting, vtkRenderer& renderer, const Placement& place, std::string& note);

/// Transfer functions, blend mode, clips, shade and lights. `scalars`: null where there are none here. `note`: what of
/// the lights is left out.
void set_look(Scene& scene, vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
              vtkDataArray* scalars, vtkRenderer& renderer, const Placement& place, std::string& note);

/// Of a scene from a file what blocks of a volume cannot find: values between voxels, and the ball that a camera fits,
/// are those of `linear` and `--fit volume` where it leaves them open. Throws Error{usage} without the points of a
/// transfer function.
void suit_blocks(Scene& scene);

}  // namespace chiaro::from_vtk
