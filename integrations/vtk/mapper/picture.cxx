#include "picture.h"

#include <algorithm>

#include "vtkNew.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"
#include "vtk_glew.h"

namespace chiaro::from_vtk {
namespace {

constexpr const char* fragment_shader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D picture;
void main() { gl_FragData[0] = texture(picture, texCoord); }
)";

}  // namespace

struct Picture::Texture {
    vtkNew<vtkTextureObject> object;
};

Picture::Picture() = default;
Picture::~Picture() = default;

bool Picture::draw(vtkRenderer& renderer, int width, int height, const std::vector<float>& rgba) {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer.GetVTKWindow());
    if (!window) return false;
    if (!texture_) texture_ = std::make_unique<Texture>();
    vtkTextureObject& texture = *texture_->object;
    texture.SetContext(window);
    texture.SetMinificationFilter(vtkTextureObject::Linear);
    texture.SetMagnificationFilter(vtkTextureObject::Linear);
    texture.SetWrapS(vtkTextureObject::ClampToEdge);
    texture.SetWrapT(vtkTextureObject::ClampToEdge);
    if (!texture.Create2DFromRaw(unsigned(width), unsigned(height), 4, VTK_FLOAT, const_cast<float*>(rgba.data())))
        return false;
    if (!quad_) quad_ = std::make_unique<vtkOpenGLQuadHelper>(window, nullptr, fragment_shader, nullptr);
    if (!quad_->Program) return false;

    vtkOpenGLState* state = window->GetState();
    const vtkOpenGLState::ScopedglEnableDisable depth_test(state, GL_DEPTH_TEST), blend(state, GL_BLEND),
        culling(state, GL_CULL_FACE);
    const vtkOpenGLState::ScopedglDepthMask depth_mask(state);
    const vtkOpenGLState::ScopedglBlendFuncSeparate function(state);
    state->vtkglDisable(GL_DEPTH_TEST);  // rays have ended where they are hidden
    state->vtkglDisable(GL_CULL_FACE);
    state->vtkglDepthMask(GL_FALSE);
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    window->GetShaderCache()->ReadyShaderProgram(quad_->Program);
    texture.Activate();
    quad_->Program->SetUniformi("picture", texture.GetTextureUnit());
    quad_->Render();
    texture.Deactivate();
    return true;
}

std::vector<float> shown_rows(const Frame& frame, const Image& developed, const ToneMap& tone, vtkRenderer& renderer) {
    const bool encodes_itself = renderer.GetRenderWindow()->GetUseSRGBColorSpace();
    const bool as_it_is =
        tone.transparent && tone.tone == Tone::none && (tone.color == ColorMode::linear) == encodes_itself;
    std::vector<float> rows(std::size_t(4) * frame.width * frame.height);
    const std::size_t channels = developed.pixels.size() / (rows.size() / 4);  // 3: opaque
    const auto put = [&](const auto* from, float* to) {
        to[3] = channels == 4 ? from[3] / 255.0f : 1;
        for (std::size_t c = 0; c < 3; ++c) to[c] = from[c] / 255.0f * to[3];
    };
    const Frame exposed = as_it_is ? expose(frame, tone) : Frame();
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const std::size_t pixel = std::size_t(frame.height - 1 - y) * frame.width + x;
            float* to = &rows[4 * (std::size_t(y) * frame.width + x)];
            if (as_it_is)
                std::copy_n(&exposed.rgba[4 * pixel], 4, to);
            else
                put(&developed.pixels[channels * pixel], to);
        }
    return rows;
}

void Picture::release(vtkWindow* window) {
    quad_.reset();
    if (texture_) texture_->object->ReleaseGraphicsResources(window);
    texture_.reset();
}

}  // namespace chiaro::from_vtk
