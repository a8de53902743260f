#include "render/session_state.h"

namespace chiaro {

Session::Session(const Device& device) : state_(std::make_unique<State>(device)) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

void Session::show(Volume&& volume, Progress& progress) {
    if (volume.components > 1) return show(components_of(std::move(volume)), progress);
    // The old volume, and all that was made from it, go before the new one takes its memory.
    state_ = std::make_unique<State>(state_->device);
    state_->show(volume, progress, [&](const Device& device) { return upload(device, std::move(volume), progress); });
}

void Session::show(const Volume& volume, Progress& progress) {
    if (volume.components > 1) return show(components_of(volume), progress);
    state_ = std::make_unique<State>(state_->device);
    state_->show(volume, progress, [&](const Device& device) { return upload(device, volume, progress); });
}

void Session::show(std::vector<Volume>&& channels, Progress& progress) {
    if (channels.size() == 1) return show(std::move(channels.front()), progress);
    state_ = std::make_unique<State>(state_->device);
    state_->show_channels(std::move(channels), progress);
}

void Session::show_moment(Volume&& volume, Progress& progress) {
    state_ = state_->for_moment(volume);
    state_->show_moment(std::move(volume), progress);
}

void Session::show_moment(const Volume& volume, Progress& progress) {
    state_ = state_->for_moment(volume);
    if (volume.components > 1) return state_->show_moment(volume, progress);
    state_->upload_by([&](const Device& device) { return upload(device, volume, progress); }, progress);
}

void Session::show(std::shared_ptr<const BrickSource> source, const PagingSettings& settings, Progress& progress) {
    const Device& given = state_->device;
    state_ = std::make_unique<State>(given.has_gpu() ? Device::cpu(given.threads, given.isa) : given);
    state_->refiner = std::make_shared<Refiner>(source, settings);
    Volume volume = read_level(*source, state_->refiner->whole_level(), progress);
    Refiner& refiner = *state_->refiner;
    state_->show(volume, progress, [&](const Device& device) {
        return refiner.with_exact_range(upload(device, std::move(volume), progress), progress);
    });
}

void Session::expect_one_look() { state_->one_look = true; }

Session Session::share_volume() const {
    Session other(state_->device);
    State& s = *other.state_;
    s.subject = state_->subject;
    s.upload.result = state_->upload.result, s.refiner = state_->refiner;
    s.others = state_->others, s.own_color = state_->own_color;
    s.shared_labels = state_->shared_labels;
    s.upload.inputs = {0};
    s.upload.version = ++s.last_version;
    return other;
}

const Image& Session::render(const Scene& given, Progress& progress, const Preview& preview) {
    const CancelScope scope(progress);
    State& s = *state_;
    const Scene scene = s.as_drawn(given);
    s.redo_up_to_classify(scene, progress);
    s.redo_interpolate(scene, progress);
    const Medium& medium = s.medium;
    const Version version = s.medium_version(scene);
    s.camera = s.fitted(scene, version, progress);
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
            if (s.refiner) {
                const auto show = [&] { preview(develop(frame, scene.output)); };
                s.paging = s.refiner->render(
                    {s.device, medium, s.illuminate.result, lighting, camera, scene, frame, cast.render_statistics},
                    progress, preview ? std::function<void()>(show) : nullptr);
                if (s.paging->level != s.refiner->whole_level()) return;
            }
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

const Image& Session::preview(const Scene& given, Progress& progress, DraftLight light, const Preview& coarse) {
    const CancelScope scope(progress);
    State& s = *state_;
    const Scene scene = s.as_drawn(given);
    const bool is_soon = light == DraftLight::soon && s.is_lit_soon(scene), lit = light != DraftLight::last && !is_soon;
    if (const Image* drawn = lit ? nullptr : s.draw_every_other_voxel(scene, progress)) return *drawn;
    if (lit)
        s.redo_up_to_classify(scene, progress);
    else
        s.begin(), s.redo_classify(scene, progress);
    const bool is_draft = has_linear_drafts(scene);
    // The camera fits what the final picture shows, unless that takes long to know.
    const bool asks_final = lit || !is_draft || (!s.is_fitted(scene.camera) && !is_large(s.upload.result));
    if (asks_final) s.redo_interpolate(scene, progress);
    s.camera = s.fitted(scene, asks_final ? s.medium_version(scene) : s.classify.version, progress);
    const Camera camera = s.camera_of(s.camera);
    const Lighting lighting = s.lighting_of(scene, camera);
    if (lit) s.redo_illuminate(scene, camera, lighting, progress, coarse, State::OfCoarseLight::drafts);
    if (is_soon) s.redo_soon(scene, lighting, progress);
    const IlluminationField field = is_soon ? spread_out(s.soon.result) : s.illuminate.result;
    if (is_draft) s.medium = s.classify.result.medium;
    return s.draw_draft(scene, field, lighting, camera, progress);
}

CameraSettings Session::fit(const Scene& scene, Progress& progress) {
    State& s = *state_;
    const std::vector<Stage> shown = s.shown;
    s.begin();
    s.redo_classify(scene, progress);
    if (!s.is_fitted(scene.camera)) s.redo_interpolate(scene, progress);
    const CameraSettings camera = s.fitted(scene, s.medium_version(scene), progress);
    s.shown = shown;  // the next picture tells
    return camera;
}

CameraSettings Session::fit_all_around(const Scene& scene, Progress& progress) {
    State& s = *state_;
    s.begin();
    s.redo_classify(scene, progress);
    s.redo_interpolate(scene, progress);
    CameraSettings camera;
    s.timed("fit", [&] {
        camera =
            fit_camera(s.device, medium(), scene.camera, scene.sampling, scene.width, scene.height, progress, true);
    });
    s.shown = s.stages;  // the next render tells them
    return camera;
}

void Session::find_light(const Scene& given, Progress& progress) {
    const CancelScope scope(progress);
    State& s = *state_;
    const Scene scene = s.as_drawn(given);
    s.redo_up_to_classify(scene, progress);
    s.redo_interpolate(scene, progress);
    const Camera camera = s.camera_of(scene.camera);
    s.redo_illuminate(scene, camera, s.lighting_of(scene, camera), progress, {});
    s.shown = s.stages;  // the next render tells them
}

bool Session::is_lit_soon(const Scene& given) const { return state_->is_lit_soon(state_->as_drawn(given)); }

bool Session::needs_light(const Scene& given) const {
    const State& s = *state_;
    const Scene scene = s.as_drawn(given);
    const bool has_medium = sees_opacities_alone(scene.illumination) ||
                            s.classify.inputs == std::tuple(s.upload.version, scene.transfer, scene.channels,
                                                            shape_for(scene), s.labels_of(scene));
    return !has_medium || s.prepare.inputs != std::tuple(s.upload.version, preparation_of(scene.illumination)) ||
           s.illuminate.inputs !=
               std::tuple(s.matter_version(scene), s.prepare.version, scene.illumination, s.held(scene));
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
std::vector<DeviceVolume> Session::volumes() const {
    std::vector<DeviceVolume> all{volume()};
    for (const auto& other : state_->others) all.push_back(other.volume);
    return all;
}
double Session::probe_exposure() const { return state_->probe_exposure; }
Scene Session::as_seen(Scene scene) const {
    scene.camera = camera();
    stand_by_frame(scene, volume().geometry().world);
    scene.lighting.probe.exposure = probe_exposure();
    return scene;
}
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
std::optional<PagingReport> Session::paging() const { return state_->paging; }
SourceLevel Session::finest() const { return state_->finest(); }
std::shared_ptr<const BrickSource> Session::source() const {
    return state_->refiner ? state_->refiner->source() : nullptr;
}
RenderStatistics Session::render_statistics() const { return state_->raycast.result.render_statistics; }
std::size_t Session::light_bytes() const { return state_->prepare.result.bytes() + state_->illuminate.result.bytes(); }
std::vector<std::string> Session::notes() const {
    std::vector<std::string> notes = state_->prepare.result.notes();
    if (const auto& labels = state_->labels.result)
        for (const std::string& note : labels->notes) notes.push_back("labels: " + note);
    if (std::string note = state_->device.note(); !note.empty()) notes.push_back(std::move(note));
    if (const auto& paging = state_->paging) {
        const std::vector<std::string> told = notes_of(*paging);
        notes.insert(notes.end(), told.begin(), told.end());
    }
    return notes;
}
std::vector<Channel> Session::channels(const Scene& scene) const { return state_->channels(scene); }
std::shared_ptr<const LabelVolume> Session::labels(const Scene& scene, Progress& progress) const {
    return state_->shared_labels->find(scene, progress);
}
const Statistics& Session::statistics() const { return state_->subject.statistics; }
TransferFunction Session::resolve(const TransferSettings& settings) const {
    return transfer_function_for(settings, state_->subject);
}
const TransferFunction& Session::transfer_function() const { return state_->classify.result.tf; }
const Guess& Session::guess() const { return state_->subject.guess; }

}  // namespace chiaro
