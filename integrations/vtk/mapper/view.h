// From a renderer's camera and depth buffer to Chiaro's camera and the ends of its rays.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/render.h>

#include <memory>

#include "data.h"

class vtkRenderer;

namespace chiaro::from_vtk {

/// Pixels of the window that a renderer draws into: of a tiled display, of its own tile.
struct Viewport {
    int x, y, width, height;
};
Viewport viewport_of(vtkRenderer& renderer);

/// Clip coordinates from the volume's own space.
Matrix4 matrix_of(vtkRenderer& renderer, const Placement& place);

/// Where opaque geometry hides the volume, for a picture of width × height of the viewport; none where there is none.
std::shared_ptr<const RayEnds> ends_of(vtkRenderer& renderer, const Viewport& viewport, const Matrix4& matrix,
                                       int width, int height);

}  // namespace chiaro::from_vtk
