#include "view.h"

#include <algorithm>
#include <limits>

#include "vtkCamera.h"
#include "vtkMatrix4x4.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

namespace chiaro::from_vtk {

Viewport viewport_of(vtkRenderer& renderer) {
    Viewport view{};
    renderer.GetTiledSizeAndOrigin(&view.width, &view.height, &view.x, &view.y);
    return view;
}

Matrix4 matrix_of(vtkRenderer& renderer, const Placement& place) {
    vtkMatrix4x4* of_world =
        renderer.GetActiveCamera()->GetCompositeProjectionTransformMatrix(renderer.GetTiledAspectRatio(), -1, 1);
    Matrix4 matrix;
    vtkMatrix4x4::Multiply4x4(of_world->GetData(), place.world_from_volume.data(), matrix.data());
    return matrix;
}

std::shared_ptr<const RayEnds> ends_of(vtkRenderer& renderer, const Viewport& viewport, const Matrix4& matrix,
                                       int width, int height) {
    std::vector<float> depth(std::size_t(viewport.width) * viewport.height);
    renderer.GetRenderWindow()->GetZbufferData(viewport.x, viewport.y, viewport.x + viewport.width - 1,
                                               viewport.y + viewport.height - 1, depth.data());
    if (std::all_of(depth.begin(), depth.end(), [](float z) { return z >= 1; })) return nullptr;
    Matrix4 back;
    vtkMatrix4x4::Invert(matrix.data(), back.data());
    const Camera camera = camera_of_matrix(matrix);
    const bool is_parallel = camera.projection == Projection::orthographic;
    RayEnds ends{width, height,
                 std::vector<float>(std::size_t(width) * height, std::numeric_limits<float>::infinity())};
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const int x = std::min(int((column + 0.5) * viewport.width / width), viewport.width - 1);
            const int y = std::min(int((height - row - 0.5) * viewport.height / height), viewport.height - 1);
            const float z = depth[std::size_t(y) * viewport.width + x];
            if (z >= 1) continue;
            // Of the ray's own pixel of the picture, at the depth of the window's.
            const double clip[4]{(column + 0.5) / width * 2 - 1, 1 - (row + 0.5) / height * 2, 2.0 * z - 1, 1};
            double p[4];
            vtkMatrix4x4::MultiplyPoint(back.data(), clip, p);
            const Vec3 from_eye = Vec3{p[0] / p[3], p[1] / p[3], p[2] / p[3]} - camera.eye;
            ends.mm[std::size_t(row) * width + column] =
                float(is_parallel ? dot(from_eye, camera.forward) : length(from_eye));
        }
    return std::make_shared<const RayEnds>(std::move(ends));
}

}  // namespace chiaro::from_vtk
