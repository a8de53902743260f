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

/// Colour and opacity over values, with the unit distance in the volume's own space: piecewise linear to 1/1000.
TransferFunction transfer_of(vtkVolumeProperty& property, double scale);

/// Opacity by gradient, per mm: VTK's gradients are of the values over a mean voxel edge. Empty: none.
std::vector<GradientPoint> gradient_opacity_of(vtkVolumeProperty& property, double mean_edge_mm);

/// Transfer function, blend mode, clips, shade and light. `note`: what of the light is left out.
void set_look(Scene& scene, vtkVolumeMapper& mapper, vtkVolumeProperty& property, vtkImageData& image,
              vtkRenderer& renderer, const Placement& place, std::string& note);

/// Of a scene from a file what blocks of a volume cannot find: values between voxels, and the ball that a camera fits,
/// are those of `linear` and `--fit volume` where it leaves them open. Throws Error{usage} without the points of a
/// transfer function.
void suit_blocks(Scene& scene);

}  // namespace chiaro::from_vtk
