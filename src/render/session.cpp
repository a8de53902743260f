#include <chiaro/error.h>
#include <chiaro/session.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <tuple>

#include "classify/medium.h"
#include "core/threads.h"
#include "render/appearance.h"
#include "render/kept.h"

namespace chiaro {

struct Session::State {
    explicit State(const Device& where) : device(where.with_own_stream()) {}  // a stream of its own

    Device device;
    Subject subject;
    std::vector<Stage> shown;   // what it took to show the volume, until a render has told it
    std::vector<Stage> stages;  // of the last render
    Version last_version = 0;
    bool one_look = false, gave_back = false;  // voxels that the one look cannot show

    // The table: what each stage makes, and from what.
    Kept<DeviceVolume, Version> upload;
    Kept<Prepared, Version, IlluminationSettings> prepare;
    Kept<Classified, Version, TransferSettings, Shape> classify;
    Kept<CameraSettings, Version, CameraSettings, RaySettings, std::pair<int, int>> fit;
    Kept<Medium, Version, Interpolation> interpolate;  // of final pictures, where drafts are not as fine
    Kept<Probe, std::string> probe;
    Kept<IlluminationField, Version, Version, IlluminationSettings, HeldLight> illuminate;
    Kept<Cast, Version, Version, Lighting, Camera, RaySettings, std::pair<int, int>> raycast;
    Kept<Image, Version, ToneMap> develop;
    Medium medium;  // of the last render or preview
    Cast previewed;
    Image previewed_image;
    CameraSettings camera;  // of the last render or preview
    double probe_exposure = 0;

    /// Calls stage(result), unless the kept result was made from these very inputs.
    template <class Result, class... Inputs, class Verb>
    void redo(std::string name, Kept<Result, Inputs...>& kept, std::tuple<Inputs...> inputs, Verb&& verb) {
        stages.push_back({std::move(name), 0});
        if (kept.inputs == inputs) return;
        kept.inputs.reset();  // a stage that throws leaves nothing that could serve
        const auto start = std::chrono::steady_clock::now();
        verb(kept.result);
        stages.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        kept.inputs = std::move(inputs);
        kept.version = ++last_version;
    }

    /// The scene's, with its probe loaded and standing as the camera's orbit has it.
    Lighting lighting_of(const Scene& scene, const Camera& camera) {
        Lighting lighting = scene.lighting;
        lighting.probe_up = camera.orbit_up;
        if (!lighting.probe.source.empty()) {
            redo("probe", probe, {lighting.probe.source},
                 [&](Probe& loaded) { loaded = load_probe(lighting.probe.source); });
            lighting.loaded_probe = probe.result;
        }
        lighting.probe.exposure = probe_exposure = exposure_stops(lighting);
        return lighting;
    }

    /// The scene's camera with the ball that it fits, of values that are linear between voxels: so that drafts and
    /// final pictures have one. Zoom changes nothing about it.
    CameraSettings fitted(const Scene& scene, Progress& progress) {
        CameraSettings camera = scene.camera;
        look_from(camera, upload.result.geometry().world);
        if (camera.fit == Fit::volume || camera.fit_centre) return camera;
        camera.zoom = 1;
        RaySettings rays = scene.sampling;
        rays.ends = nullptr;
        const auto [width, height] = std::pair(scene.width, scene.height);
        redo("fit", fit, {classify.version, camera, rays, {width, height}}, [&](CameraSettings& found) {
            found = fit_camera(device, classify.result.medium, camera, rays, width, height, progress);
        });
        camera = fit.result, camera.zoom = scene.camera.zoom;
        return camera;
    }

    Camera camera_of(const CameraSettings& settings) const {
        return make_camera(settings, upload.result.geometry(), upload.result.dimensions());
    }

    /// What the scene's light would leave in a field; a probe that is not loaded yet is none.
    HeldLight held(const Scene& scene) const {
        Lighting lighting = scene.lighting;
        lighting.probe_up = camera_of(scene.camera).orbit_up;
        if (!lighting.probe.source.empty())
            lighting.loaded_probe = probe.inputs == std::tuple(lighting.probe.source) ? probe.result : Probe();
        return held_light(lighting, scene.illumination);
    }

    template <class Upload>
    void show(const Volume& volume, Progress& progress, Upload&& upload_to) {
        const CancelScope scope(progress);
        progress.report("measure", 0);
        Kept<Subject, Version> measured;
        redo("measure", measured, {0}, [&](Subject& studied) { studied = study(volume, progress); });
        subject = std::move(measured.result);
        upload_by(upload_to, progress);
    }

    /// With what all moments have in common, and nothing else.
    std::unique_ptr<State> for_moment(const Volume& volume) const {
        if (volume.dimensions != upload.result.dimensions())
            throw Error(ErrorCode::input,
                        fmt::format("moment {} has {} voxels, where the first one has {}", volume.moments.shown,
                                    to_text(volume.dimensions), to_text(upload.result.dimensions())));
        auto moment = std::make_unique<State>(device);
        moment->subject = subject, moment->one_look = one_look, moment->probe = probe;
        return moment;
    }

    template <class Upload>
    void upload_by(Upload&& upload_to, Progress& progress) {
        const CancelScope scope(progress);
        progress.report("upload", 0);
        redo("upload", upload, {0}, [&](DeviceVolume& voxels) { voxels = upload_to(device); });
        shown = stages;
    }

    void begin() {
        if (!upload.inputs) throw Error(ErrorCode::internal, "a session must show a volume before it renders");
        stages = shown;
        for (Stage& stage : shown) stage.seconds = 0;
    }

    /// The stages that pictures and fields have in common.
    void redo_up_to_classify(const Scene& scene, Progress& progress) {
        begin();
        const DeviceVolume& voxels = upload.result;
        redo("prepare", prepare, {upload.version, preparation_of(scene.illumination)},
             [&](Prepared& prepared) { prepared = chiaro::prepare(device, voxels, scene.illumination, progress); });
        tell_steps(prepare.result.stages());
        progress.check();
        redo_classify(scene, progress);
    }

    void redo_classify(const Scene& scene, const Progress& progress) {
        const Shape shape = shape_for(scene);
        const std::tuple inputs(upload.version, scene.transfer, shape);
        if (gave_back && (classify.inputs != inputs || !looks_at_visible_voxels(scene)))
            throw Error(ErrorCode::internal, "a session of one look was asked for another");
        redo("classify", classify, inputs, [&](Classified& classified) {
            classified.tf = transfer_function_for(scene.transfer, subject);
            classified.medium = chiaro::classify(device, upload.result, classified.tf, shape, progress);
        });
        medium = classify.result.medium;
    }

    /// The medium of final pictures.
    void redo_interpolate(const Scene& scene, const Progress& progress) {
        if (has_finer_interpolation(scene)) {
            if (gave_back && !medium_version(scene))
                throw Error(ErrorCode::internal, "a session of one look was asked for another");
            redo("interpolate", interpolate, {classify.version, scene.interpolation}, [&](Medium& finer) {
                finer = finely_interpolated(device, classify.result.medium, scene, subject.statistics.noise, progress);
            });
            medium = interpolate.result;
        }
        if (gave_back || !one_look || !looks_at_visible_voxels(scene)) return;
        discard_unseen(medium);
        gave_back = true;
    }

    /// Names the medium that redo_interpolate made for the scene; 0: it would be another.
    Version medium_version(const Scene& scene) const {
        if (!has_finer_interpolation(scene)) return classify.version;
        return interpolate.inputs == std::tuple(classify.version, scene.interpolation) ? interpolate.version : 0;
    }

    void redo_illuminate(const Scene& scene, const Camera& camera, const Lighting& lighting, Progress& progress,
                         const Preview& preview) {
        redo("illuminate", illuminate,
             {medium_version(scene), prepare.version, scene.illumination, held_light(lighting, scene.illumination)},
             [&](IlluminationField& field) {
                 const IlluminationField warm = field;
                 const auto keep = [&](IlluminationField finer) {
                     field = std::move(finer);
                     if (!preview || !field.is_coarse()) return;
                     DeviceFrame frame(scene.width, scene.height);
                     chiaro::raycast(device, medium, field, lighting, camera, scene.sampling, frame, progress);
                     if (!progress.cancelled()) preview(chiaro::develop(frame, scene.output));
                 };
                 chiaro::illuminate(device, medium, prepare.result, lighting, scene.illumination, keep, progress, warm);
                 progress.check();
             });
        tell_steps(illuminate.result.stages());
    }

    /// A stage that is done anew each time.
    template <class Verb>
    void timed(std::string name, Verb&& verb) {
        Kept<int> nothing;
        redo(std::move(name), nothing, {}, [&](int&) { verb(); });
    }

    /// What the last stage consisted of.
    void tell_steps(const std::vector<Stage>& steps) {
        const bool is_kept = stages.back().seconds == 0;
        for (const Stage& step : steps) stages.push_back({step.name, is_kept ? 0 : step.seconds});
    }
};

Session::Session(const Device& device) : state_(std::make_unique<State>(device)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

void Session::show(Volume&& volume, Progress& progress) {
    // The old volume, and all that was made from it, go before the new one takes its memory.
    state_ = std::make_unique<State>(state_->device);
    state_->show(volume, progress, [&](const Device& device) { return upload(device, std::move(volume), progress); });
}

void Session::show(const Volume& volume, Progress& progress) {
    state_ = std::make_unique<State>(state_->device);
    state_->show(volume, progress, [&](const Device& device) { return upload(device, volume, progress); });
}

void Session::show_moment(Volume&& volume, Progress& progress) {
    state_ = state_->for_moment(volume);
    state_->upload_by([&](const Device& device) { return upload(device, std::move(volume), progress); }, progress);
}

void Session::show_moment(const Volume& volume, Progress& progress) {
    state_ = state_->for_moment(volume);
    state_->upload_by([&](const Device& device) { return upload(device, volume, progress); }, progress);
}

void Session::expect_one_look() { state_->one_look = true; }

Session Session::share_volume() const {
    Session other(state_->device);
    State& s = *other.state_;
    s.subject = state_->subject;
    s.upload.result = state_->upload.result;
    s.upload.inputs = {0};
    s.upload.version = ++s.last_version;
    return other;
}

const Image& Session::render(const Scene& scene, Progress& progress, const Preview& preview) {
    const CancelScope scope(progress);
    State& s = *state_;
    s.redo_up_to_classify(scene, progress);
    s.camera = s.fitted(scene, progress);
    s.redo_interpolate(scene, progress);
    const Medium& medium = s.medium;
    const Version version = s.medium_version(scene);
    const Camera camera = s.camera_of(s.camera);
    const Lighting lighting = s.lighting_of(scene, camera);

    s.redo_illuminate(scene, camera, lighting, progress, preview);
    const std::pair size(scene.width, scene.height);
    s.redo(
        "raycast", s.raycast, {version, s.illuminate.version, lighting, camera, scene.sampling, size}, [&](Cast& cast) {
            DeviceFrame& frame = cast.frame;
            frame.resize(scene.width, scene.height);
            const auto keep = [&](const DeviceFrame& better, const PathStatistics& paths) {
                cast.render_statistics.paths = paths;
                preview(develop(better, scene.output));
            };
            cast.render_statistics =
                is_path_traced(scene.illumination)
                    ? trace_paths(s.device, medium, lighting, camera, scene.sampling, scene.illumination, frame,
                                  progress, preview ? keep : DeviceFramePreview())
                    : raycast(s.device, medium, s.illuminate.result, lighting, camera, scene.sampling, frame, progress);
            progress.check();
        });

    s.redo("develop", s.develop, {s.raycast.version, scene.output},
           [&](Image& image) { image = develop(s.raycast.result.frame, scene.output); });
    return s.develop.result;
}

const Image& Session::preview(const Scene& scene, Progress& progress, bool lit) {
    const CancelScope scope(progress);
    State& s = *state_;
    if (lit)
        s.redo_up_to_classify(scene, progress);
    else
        s.begin(), s.redo_classify(scene, progress);
    s.camera = s.fitted(scene, progress);
    const bool is_draft = scene.interpolation == Interpolation::automatic && has_finer_interpolation(scene);
    if (lit || !is_draft) s.redo_interpolate(scene, progress);
    const Camera camera = s.camera_of(s.camera);
    const Lighting lighting = s.lighting_of(scene, camera);
    if (lit) s.redo_illuminate(scene, camera, lighting, progress, {});
    if (is_draft) s.medium = s.classify.result.medium;
    const Medium& medium = s.medium;
    DeviceFrame& frame = s.previewed.frame;
    frame.resize(scene.width, scene.height);
    s.timed("raycast", [&] {
        IlluminationSettings settings = scene.illumination;
        settings.reference.rays = 1;
        s.previewed.render_statistics =
            is_path_traced(settings)
                ? trace_paths(s.device, medium, lighting, camera, scene.sampling, settings, frame, progress)
                : raycast(s.device, medium, s.illuminate.result, lighting, camera, scene.sampling, frame, progress);
        progress.check();
    });
    s.timed("develop", [&] { s.previewed_image = develop(frame, scene.output); });
    return s.previewed_image;
}

CameraSettings Session::fit(const Scene& scene, Progress& progress) {
    State& s = *state_;
    s.begin();
    s.redo_classify(scene, progress);
    return s.fitted(scene, progress);
}

CameraSettings Session::fit_all_around(const Scene& scene, Progress& progress) {
    State& s = *state_;
    s.begin();
    s.redo_classify(scene, progress);
    CameraSettings camera;
    s.timed("fit", [&] {
        camera =
            fit_camera(s.device, medium(), scene.camera, scene.sampling, scene.width, scene.height, progress, true);
    });
    s.shown = s.stages;  // the next render tells them
    return camera;
}

bool Session::needs_light(const Scene& scene) const {
    const State& s = *state_;
    return s.prepare.inputs != std::tuple(s.upload.version, preparation_of(scene.illumination)) ||
           s.classify.inputs != std::tuple(s.upload.version, scene.transfer, shape_for(scene)) ||
           s.illuminate.inputs !=
               std::tuple(s.medium_version(scene), s.prepare.version, scene.illumination, s.held(scene));
}

ComputedField Session::compute_field(const Scene& scene, Progress& progress) {
    const CancelScope scope(progress);
    State& s = *state_;
    if (s.gave_back) throw Error(ErrorCode::internal, "a session of one look has no whole volume");
    s.redo_up_to_classify(scene, progress);
    s.redo_interpolate(scene, progress);
    const Lighting lighting = s.lighting_of(scene, s.camera_of(scene.camera));
    Kept<ComputedField, Version> made;
    s.redo("illuminate", made, {s.classify.version}, [&](ComputedField& field) {
        field = chiaro::compute_field(s.device, s.medium, s.prepare.result, lighting, scene.illumination, progress);
    });
    s.tell_steps(made.result.stages);
    return std::move(made.result);
}

const DeviceVolume& Session::volume() const { return state_->upload.result; }
double Session::probe_exposure() const { return state_->probe_exposure; }
const CameraSettings& Session::camera() const { return state_->camera; }
const Medium& Session::medium() const { return state_->medium; }
const IlluminationField& Session::light() const { return state_->illuminate.result; }
const Frame& Session::frame() const { return state_->raycast.result.frame.read(); }
const Frame& Session::frame_with_depth(Progress& progress) {
    State& s = *state_;
    DeviceFrame& frame = s.raycast.result.frame;
    const Version version = s.raycast.inputs ? std::get<0>(*s.raycast.inputs) : 0;
    const bool is_fine = s.interpolate.inputs && version == s.interpolate.version;
    if (!s.raycast.inputs || (is_fine ? std::get<0>(*s.interpolate.inputs) : version) != s.classify.version)
        throw Error(ErrorCode::internal, "a session must render a picture before it can tell its depth");
    if (frame.read().depth_mm.empty()) {
        const auto& [classified, lit, lighting, camera, rays, size] = *s.raycast.inputs;
        const Medium& shown = is_fine ? s.interpolate.result : s.classify.result.medium;
        if (!find_depth(s.device, shown, camera, rays, frame.write(), progress)) progress.check();
    }
    return frame.read();
}
const std::vector<Stage>& Session::stages() const { return state_->stages; }
RenderStatistics Session::render_statistics() const { return state_->raycast.result.render_statistics; }
std::size_t Session::light_bytes() const { return state_->prepare.result.bytes() + state_->illuminate.result.bytes(); }
std::vector<std::string> Session::notes() const {
    std::vector<std::string> notes = state_->prepare.result.notes();
    if (std::string note = state_->device.note(); !note.empty()) notes.push_back(std::move(note));
    return notes;
}
const Statistics& Session::statistics() const { return state_->subject.statistics; }
TransferFunction Session::resolve(const TransferSettings& settings) const {
    return transfer_function_for(settings, state_->subject);
}
const TransferFunction& Session::transfer_function() const { return state_->classify.result.tf; }
const Guess& Session::guess() const { return state_->subject.guess; }

}  // namespace chiaro
