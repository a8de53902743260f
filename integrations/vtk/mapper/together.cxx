// What several processes do together: light, and pictures that no blend of windows' pixels gives.
#include <chiaro/error.h>
#include <chiaro/render.h>

#include <algorithm>
#include <cstring>

#include "internals.h"
#include "view.h"
#include "vtkBoundingBox.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"

using namespace chiaro;

namespace {

/// Collective: of all processes' own voxels, by number.
std::vector<chiaro::Placement> blocks_of(Exchange& ranks, vtkImageData& grid, const std::array<int, 6>& own) {
    std::vector<chiaro::Placement> blocks;
    for (const auto& bytes : ranks.gather(std::as_bytes(std::span(own)))) {
        std::array<int, 6> theirs;
        std::memcpy(theirs.data(), bytes.data(), sizeof theirs);
        Volume block;
        from_vtk::place(block, grid, nullptr, false, theirs);
        blocks.push_back(*block.placement);
    }
    return blocks;
}

/// Collective: what went wrong, with the number of the first process where it did; empty: nothing on any.
std::string wrong_on_any(Exchange& ranks, const std::string& wrong) {
    const auto all = ranks.gather(std::as_bytes(std::span(wrong)));
    for (std::size_t rank = 0; rank < all.size(); ++rank)
        if (!all[rank].empty())
            return "rank " + std::to_string(rank) + ": " +
                   std::string(reinterpret_cast<const char*>(all[rank].data()), all[rank].size());
    return {};
}

/// What went wrong with it; empty: nothing.
template <class Work>
std::string wrong_with(const Work& work) {
    try {
        work();
        return {};
    } catch (const std::exception& error) {
        return error.what();
    }
}

/// What all processes take from the first one.
struct Aim {
    Matrix4 matrix{};
    int width = 1, height = 1;
};

}  // namespace

/// What is drawn, or why nothing can be.
std::string vtkChiaroVolumeMapper::Prepare(from_vtk::Subject& subject, Scene& scene, vtkRenderer* renderer,
                                           vtkVolume* volume) {
    std::string found;
    const std::string thrown = wrong_with([&] {
        found = this->Find(subject, volume);
        if (found.empty() && !this->Look(scene, subject, renderer, volume)) found = "a cropping box that keeps nothing";
    });
    return thrown.empty() ? found : thrown;
}

bool vtkChiaroVolumeMapper::FindLight(vtkRenderer* renderer, vtkVolume* volume) {
    Internals& self = *this->Self;
    self.together.reset();
    from_vtk::Subject subject;
    Scene scene;
    std::string wrong = wrong_on_any(*self.ranks, this->Prepare(subject, scene, renderer, volume));
    if (!wrong.empty()) {
        this->WarnOnce("not drawn: " + wrong);
        self.session.reset();
        return false;
    }
    wrong = wrong_with([&] {  // on all
        chiaro::Progress progress;
        this->Show(subject);
        self.session->find_light(scene, progress);
    });
    if (wrong.empty()) return true;
    vtkErrorMacro(<< wrong);
    self.session.reset();
    return false;
}

bool vtkChiaroVolumeMapper::DrawTogether(vtkRenderer* renderer, vtkVolume* volume, const Blend& blend) {
    Internals& self = *this->Self;
    self.together.reset();
    if (!self.session) return false;                 // on all
    renderer->UpdateLightsGeometryToFollowCamera();  // as the render does that this precedes
    from_vtk::Subject subject;
    Scene scene;
    std::string wrong = this->Prepare(subject, scene, renderer, volume);
    const from_vtk::Viewport viewport = from_vtk::viewport_of(*renderer);
    Aim aim;
    if (wrong.empty())
        aim = {scene.camera.matrix.value_or(Matrix4()), std::max(viewport.width, 1), std::max(viewport.height, 1)};
    self.ranks->broadcast(std::as_writable_bytes(std::span(&aim, 1)));
    if (scene.camera.matrix) scene.camera.matrix = aim.matrix;
    scene.width = aim.width, scene.height = aim.height;
    if (wrong.empty() && self.session->needs_light(scene)) wrong = "light that was not found yet";
    wrong = wrong_on_any(*self.ranks, wrong);
    const bool is_blended = scene.mode == Mode::dvr;
    if (wrong.empty() && is_blended && !blend) return false;

    Frame frame;
    chiaro::Progress progress;
    const auto cast = [&] { self.session->render(scene, progress), frame = self.session->frame(); };
    const auto put_together = [&] {  // what goes wrong with it does on all
        const DeviceVolume& whole = self.session->volume();
        blend(frame, front_to_back(blocks_of(*self.ranks, *subject.grid, self.own), whole.geometry(),
                                   make_camera(self.session->camera(), whole.geometry(), whole.dimensions())));
    };
    if (wrong.empty()) wrong = wrong_on_any(*self.ranks, wrong_with(cast));
    if (wrong.empty() && is_blended) wrong = wrong_with(put_together);
    if (!wrong.empty()) vtkErrorMacro(<< "not drawn: " << wrong);
    self.together = self.ranks->rank() == 0 && wrong.empty() ? std::move(frame) : Frame();
    self.fills_window = self.scene.has_value();
    return true;
}

void vtkChiaroVolumeMapper::DrawApart() { this->Self->together.reset(); }
void vtkChiaroVolumeMapper::EndDrawTogether() { this->Self->fills_window = false; }

/// The first process shows what all have made.
void vtkChiaroVolumeMapper::DrawOfAll(const Scene& scene, vtkRenderer* renderer) {
    const Frame& frame = *this->Self->together;
    if (frame.width < 1) return;
    this->Self->keep_frame(frame, scene.output);
    const Image developed = develop(frame, scene.output);
    if (!this->Self->picture.draw(*renderer, frame.width, frame.height,
                                  from_vtk::shown_rows(frame, developed, scene.output, *renderer)))
        this->WarnOnce("not drawn: a window without OpenGL");
}

double* vtkChiaroVolumeMapper::GetBounds() {
    const Internals& self = *this->Self;
    if (!self.together || !self.grid) return this->Superclass::GetBounds();
    vtkBoundingBox bounds(self.grid->GetBounds());
    if (self.fills_window) bounds.Inflate(1e3 * bounds.GetDiagonalLength());
    bounds.GetBounds(this->Bounds);
    return this->Bounds;
}
