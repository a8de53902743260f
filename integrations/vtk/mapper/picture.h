// Draws a picture over what a renderer has drawn so far.
#pragma once
#include <chiaro/image.h>

#include <memory>
#include <vector>

class vtkOpenGLQuadHelper;
class vtkRenderer;
class vtkTextureObject;
class vtkWindow;

namespace chiaro::from_vtk {

class Picture {
public:
    Picture();
    ~Picture();
    /// Premultiplied RGBA by rows from the bottom, stretched over the renderer's viewport. False without OpenGL.
    bool draw(vtkRenderer& renderer, int width, int height, const std::vector<float>& rgba);
    void release(vtkWindow* window);

private:
    struct Texture;
    std::unique_ptr<Texture> texture_;
    std::unique_ptr<vtkOpenGLQuadHelper> quad_;
};

/// Rows from the bottom, as the renderer's window shows them: of a frame with its exposure, or of the developed
/// picture, where it was bent or encoded.
std::vector<float> shown_rows(const Frame& frame, const Image& developed, const ToneMap& tone, vtkRenderer& renderer);

}  // namespace chiaro::from_vtk
