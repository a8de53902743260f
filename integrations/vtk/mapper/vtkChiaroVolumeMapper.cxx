#include "vtkChiaroVolumeMapper.h"

#include <chiaro/error.h>

#include <algorithm>
#include <chrono>

#include "internals.h"
#include "look.h"
#include "view.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

vtkStandardNewMacro(vtkChiaroVolumeMapper);

using namespace chiaro;

namespace {

/// Throws Error{usage} for a name that is no setting of a look.
void check_name(std::string_view name) {
    bool is_known = false;
    Scene scene;
    for_each_setting(
        [&](const Setting& setting, const auto&...) {
            if (name.empty() || setting.name != name) return;
            if (setting.key.starts_with("volume.") ||
                (setting.key.starts_with("camera.") && name != "aperture" && name != "focus") || name == "size")
                throw Error(ErrorCode::usage, std::string(name) + ": the data and the renderer's camera say that");
            is_known = true;
        },
        scene);
    if (!is_known)
        throw Error(ErrorCode::usage, std::string(name) + ": no setting has this name; chiaro render --help tells all");
}

}  // namespace

vtkChiaroVolumeMapper::vtkChiaroVolumeMapper() : Self(std::make_unique<Internals>()) {}
vtkChiaroVolumeMapper::~vtkChiaroVolumeMapper() = default;

bool vtkChiaroVolumeMapper::SetSetting(const char* name, const char* value) {
    const std::string key = name ? name : "", text = value ? value : "";
    try {
        check_name(key);
        GivenSettings given = this->Self->given;
        if (text.empty())
            given.erase(key);
        else
            given[key] = text;
        Scene scene;
        if (!text.empty()) set_by_name(scene, {{key, text}}, from_vtk::written);
        if (given != this->Self->given) this->Modified();
        this->Self->given = std::move(given);
        return true;
    } catch (const Error& error) {
        vtkErrorMacro(<< error.what());
        return false;
    }
}

bool vtkChiaroVolumeMapper::SetScene(const char* file) {
    try {
        std::optional<Scene> scene;
        std::vector<std::string> notes;
        if (file && *file) scene = read_scene(file, {}, notes);
        for (const std::string& note : notes) this->WarnOnce("scene: " + note);
        this->Self->scene = std::move(scene);
        this->Modified();
        return true;
    } catch (const Error& error) {
        vtkErrorMacro(<< error.what());
        return false;
    }
}

bool vtkChiaroVolumeMapper::SetFrameFile(const char* file) {
    const std::string name = file ? file : "";
    if (!name.empty() && !name.ends_with(".exr")) {
        vtkErrorMacro(<< name << ": a frame's light is written as .exr");
        return false;
    }
    this->Self->frame_file = name;
    return true;
}

const char* vtkChiaroVolumeMapper::GetSetting(const char* name) {
    const auto found = this->Self->given.find(std::string_view(name ? name : ""));
    return found == this->Self->given.end() ? "" : found->second.c_str();
}

bool vtkChiaroVolumeMapper::SetStrength(double strength) {
    return this->SetSetting("strength", std::to_string(strength).c_str());
}

void vtkChiaroVolumeMapper::WarnOnce(const std::string& what) {
    if (this->Self->warned.insert(what).second) vtkWarningMacro(<< what);
}

void vtkChiaroVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume) {
    const auto start = std::chrono::steady_clock::now();
    try {
        this->Draw(renderer, volume);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
    }
    this->TimeToDraw = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void vtkChiaroVolumeMapper::SetBlock(std::shared_ptr<Exchange> ranks, vtkImageData* whole, const int own[6]) {
    Internals& self = *this->Self;
    std::array<int, 6> given{};
    if (ranks) std::copy_n(own, 6, given.begin());
    const auto same = [&] {
        if (!self.grid || !ranks) return self.grid == nullptr && !ranks;
        return std::equal(whole->GetExtent(), whole->GetExtent() + 6, self.grid->GetExtent());
    };
    if (self.ranks != ranks || self.own != given || !same()) self.session.reset();
    self.ranks = std::move(ranks), self.own = given, self.grid = self.ranks ? whole : nullptr;
}

/// What cannot be drawn; empty: all can.
std::string vtkChiaroVolumeMapper::Find(from_vtk::Subject& subject, vtkVolume* volume) {
    Internals& self = *this->Self;
    vtkImageData* image = vtkImageData::SafeDownCast(this->GetInput());
    if (!image && !self.ranks) return "rectilinear grids";
    if (image)
        subject.scalars = vtkAbstractMapper::GetScalars(image, this->ScalarMode, this->ArrayAccessMode, this->ArrayId,
                                                        this->ArrayName, subject.at_cells);
    if (subject.scalars && subject.scalars->GetNumberOfTuples() > 0) subject.image = image;
    if (!subject.image && !self.ranks) return "an image without scalars";
    if (self.ranks && this->Cropping) return "cropping regions over several processes";
    vtkVolumeProperty& property = *volume->GetProperty();
    const int count = subject.image ? subject.scalars->GetNumberOfComponents() : 1;
    if (self.ranks && count > 1) return "scalars of several components over several processes";
    if (self.ranks && property.GetTransferFunctionMode() == vtkVolumeProperty::TF_2D)
        return "TF_2D over several processes";
    subject.dependent = from_vtk::is_dependent(property, count);
    if (subject.image)
        if (std::string what = from_vtk::not_drawn(*this, property, *image, *subject.scalars); !what.empty())
            return what;
    subject.grid = self.ranks ? self.grid.Get() : image;
    subject.place = from_vtk::placement_of(*subject.grid, subject.at_cells, *volume->GetMatrix());
    return {};
}

/// Hands the session its voxels, where they are others than before; collective. False where they are the same.
bool vtkChiaroVolumeMapper::Show(const from_vtk::Subject& subject) {
    Internals& self = *this->Self;
    const vtkMTimeType time =
        subject.image ? std::max(subject.image->GetMTime(), subject.scalars->GetMTime()) : vtkMTimeType(0);
    const from_vtk::Shown shown{
        subject.scalars, time, subject.at_cells != 0, subject.dependent, subject.place.geometry, this->NumberOfThreads};
    if (self.agree(self.session && shown == self.shown)) return false;
    const Device host = Device::cpu(this->NumberOfThreads);
    Device device = self.ranks ? host : choose_device(host).device;
    device.ranks = self.ranks;
    self.session = std::make_unique<Session>(device);
    self.shown = {};  // an exception leaves nothing that could serve
    Volume voxels;
    if (subject.image)
        voxels = from_vtk::volume_of(*subject.image, *subject.scalars, subject.at_cells, subject.place.geometry);
    if (self.ranks) from_vtk::place(voxels, *subject.grid, subject.image, subject.at_cells, self.own);
    chiaro::Progress progress;
    if (voxels.components > 1)
        self.session->show(from_vtk::channels_of(voxels, subject.dependent), progress);
    else
        self.session->show(voxels, progress);
    self.shown = shown;
    return true;
}

/// False where nothing of it is kept.
bool vtkChiaroVolumeMapper::Look(Scene& scene, const from_vtk::Subject& subject, vtkRenderer* renderer,
                                 vtkVolume* volume) {
    if (this->Self->scene) {
        scene = *this->Self->scene;
        if (this->Self->ranks) from_vtk::suit_blocks(scene);
        return true;
    }
    std::string note;
    scene.output.color = renderer->GetRenderWindow()->GetUseSRGBColorSpace() ? ColorMode::linear : ColorMode::display;
    scene.output.transparent = true;
    from_vtk::set_look(scene, *this, *volume->GetProperty(), *subject.grid, subject.scalars, *renderer, subject.place,
                       note);
    if (!note.empty()) this->WarnOnce(note);
    if (scene.clip.box)
        for (std::size_t a = 0; a < 3; ++a)
            if (!((*scene.clip.box)[2 * a] < (*scene.clip.box)[2 * a + 1])) return false;
    const from_vtk::Placement& place = subject.place;
    scene.sampling.step_voxels =
        this->SampleDistance > 0 ? this->SampleDistance / (place.scale * place.geometry.smallest_spacing_mm()) : 0.5;
    set_by_name(scene, this->Self->given, from_vtk::written);
    if (this->Self->ranks) from_vtk::suit_blocks(scene);
    scene.camera.matrix = from_vtk::matrix_of(*renderer, place);
    return true;
}

void vtkChiaroVolumeMapper::Draw(vtkRenderer* renderer, vtkVolume* volume) {
    Internals& self = *this->Self;
    from_vtk::Subject subject;
    if (const std::string what = this->Find(subject, volume); !what.empty())
        return this->WarnOnce("not drawn: " + what);
    if (self.ranks && !self.session) return;  // FindLight told why
    if (!self.ranks) this->Show(subject);
    Scene scene;
    if (!this->Look(scene, subject, renderer, volume)) return;

    const from_vtk::Viewport view = from_vtk::viewport_of(*renderer);
    if (view.width < 1 || view.height < 1) return;
    double apart = this->ImageSampleDistance;
    const bool adjusts = this->AutoAdjustSampleDistances && !self.ranks;  // each rank would choose a size of its own
    if (const double allowed = volume->GetAllocatedRenderTime(); adjusts && allowed > 0)
        apart = std::clamp(std::sqrt(self.seconds_a_pixel * view.width * view.height / allowed), apart, 10.0);
    scene.width = std::max(int(view.width / apart), 1), scene.height = std::max(int(view.height / apart), 1);
    self.keep(this->IntermixIntersectingGeometry && scene.camera.matrix
                  ? from_vtk::ends_of(*renderer, view, *scene.camera.matrix, scene.width, scene.height)
                  : nullptr);
    scene.sampling.ends = self.ends;

    if (self.together) return this->DrawOfAll(scene, renderer);
    if (self.ranks && (scene.mode != Mode::dvr || self.scene))
        return this->WarnOnce(
            "not drawn: over several processes this blend mode, and scenes of files, are not drawn "
            "beside other geometry, nor without exact compositing");
    chiaro::Progress progress;
    if (self.ranks && self.session->needs_light(scene))
        return this->WarnOnce("not drawn: light that was not found yet");
    const Image& picture = self.session->render(scene, progress);
    if (!self.ranks) self.keep_frame(self.session->frame(), scene.output);
    for (const Stage& stage : self.session->stages())
        if (stage.name == "raycast" && stage.seconds > 0)
            self.seconds_a_pixel = stage.seconds / (double(scene.width) * scene.height);
    if (!self.picture.draw(*renderer, scene.width, scene.height,
                           from_vtk::shown_rows(self.session->frame(), picture, scene.output, *renderer)))
        this->WarnOnce("not drawn: a window without OpenGL");
}

void vtkChiaroVolumeMapper::ReleaseGraphicsResources(vtkWindow* window) { this->Self->picture.release(window); }

void vtkChiaroVolumeMapper::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "SampleDistance: " << this->SampleDistance << "\n";
    os << indent << "ImageSampleDistance: " << this->ImageSampleDistance << "\n";
    os << indent << "AutoAdjustSampleDistances: " << this->AutoAdjustSampleDistances << "\n";
    os << indent << "IntermixIntersectingGeometry: " << this->IntermixIntersectingGeometry << "\n";
    os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
    for (const auto& [name, value] : this->Self->given) os << indent << name << ": " << value << "\n";
}
