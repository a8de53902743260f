// What stands behind a Session: a table of stages.
#pragma once
#include <chiaro/error.h>
#include <chiaro/session.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <tuple>
#include <variant>

#include "classify/labels/labelled.h"
#include "classify/medium.h"
#include "core/threads.h"
#include "illumination/soon_lit.h"
#include "render/appearance.h"
#include "render/kept.h"
#include "render/refine.h"
#include "render/shared_labels.h"
#include "volume/every_other.h"

namespace chiaro {

struct Session::State {
    explicit State(const Device& where) : device(where.with_own_stream()) {}  // a stream of its own

    Device device;
    Subject subject;
    std::shared_ptr<Refiner> refiner;    // of a volume that is read by bricks; `upload` has its whole level
    std::optional<PagingReport> paging;  // of the last render of one
    std::vector<Stage> shown;            // what it took to show the volume, until a render has told it
    std::vector<Stage> stages;           // of the last render
    Version last_version = 0;
    bool one_look = false, gave_back = false;  // voxels that the one look cannot show

    /// Of volumes of several channels: all but the first.
    struct OtherChannel {
        Subject subject;
        DeviceVolume volume;
    };
    std::vector<OtherChannel> others;
    /// Others are red, green, blue; or the value that colours are by.
    enum class OwnColor { none, by_luminance, by_alpha, by_value } own_color = OwnColor::none;
    std::shared_ptr<SharedLabels> shared_labels = std::make_shared<SharedLabels>();

    // The table: what each stage makes, and from what.
    Kept<DeviceVolume, Version> upload;
    Kept<Prepared, Version, IlluminationSettings> prepare;
    Kept<std::shared_ptr<const LabelVolume>, SharedLabels::Key> labels;
    LabelBorders borders;
    Kept<std::shared_ptr<const LabelBricks>, Version, Version, std::vector<LabelChange>, ColorMode> labelled;
    Kept<Classified, Version, TransferSettings, std::vector<ChannelSettings>, Shape, Version> classify;
    Kept<CameraSettings, Version, CameraSettings, RaySettings, std::pair<int, int>> fit;
    Kept<Medium, Version, Interpolation> interpolate;  // of final pictures, where drafts are not as fine
    /// What `opacities` names: all that they come from.
    Kept<std::monostate, Version, TransferSettings, std::vector<ChannelSettings>, Shape, Version, Interpolation>
        opacities;
    Kept<Probe, std::string, std::vector<Light>> probe;
    Kept<IlluminationField, Version, Version, IlluminationSettings, HeldLight> illuminate;
    Kept<DeviceVolume, Version> every_other;
    Kept<Medium, Version, TransferSettings, Shape> every_other_medium;
    Kept<IlluminationField, Version, TransferSettings, Shape, IlluminationSettings> soon;  // of every other voxel
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
        turn_by_frame(lighting.probe, upload.result.geometry().world);
        lighting.probe_up = camera.orbit_up;
        if (!lighting.probe.source.empty()) {
            redo("probe", probe, probe_inputs(lighting), [&](Probe& loaded) { loaded = load_probe(lighting); });
            lighting.loaded_probe = probe.result;
        }
        lighting.probe.exposure = probe_exposure = exposure_stops(lighting);
        return lighting;
    }

    /// Whether nothing has to be looked for to know the ball that it fits.
    static bool is_fitted(const CameraSettings& camera) { return camera.fit == Fit::volume || camera.fit_centre; }
    /// The scene's camera with the ball that it fits, of what `medium` shows, which has that version. Zoom changes
    /// nothing about it.
    CameraSettings fitted(const Scene& scene, Version version, Progress& progress) {
        CameraSettings camera = scene.camera;
        look_from(camera, upload.result.geometry().world);
        if (is_fitted(camera)) return camera;
        camera.zoom = 1;
        RaySettings rays = scene.sampling;
        rays.ends = nullptr;
        const auto [width, height] = std::pair(scene.width, scene.height);
        redo("fit", fit, {version, camera, rays, {width, height}},
             [&](CameraSettings& found) { found = fit_camera(device, medium, camera, rays, width, height, progress); });
        camera = fit.result, camera.zoom = scene.camera.zoom;
        return camera;
    }

    SourceLevel finest() const {
        return refiner ? refiner->finest() : SourceLevel{upload.result.dimensions(), upload.result.geometry()};
    }

    Camera camera_of(const CameraSettings& settings) const {
        const SourceLevel level = finest();
        return make_camera(settings, level.geometry, level.dimensions);
    }

    /// Bricks have no splines, which between a coarse level's voxels would show nothing either. Lengths in voxels are
    /// those of the volume, whichever level light is found on.
    Scene as_drawn(Scene scene) const {
        if (!refiner) return scene;
        if (scene.interpolation == Interpolation::automatic) scene.interpolation = Interpolation::linear;
        // Of spao each shell is twice as wide as the one before. With fewer than three the picture of level 5 of
        // sample:shells:8192 is .02 too bright, with three .009.
        constexpr int least_shells = 3;
        int& shells = scene.illumination.spao.levels;
        shells = std::max(shells - refiner->whole_level(), std::min(shells, least_shells));
        return scene;
    }

    /// What the scene's light would leave in a field; a probe that is not loaded yet is none.
    HeldLight held(const Scene& scene) const {
        Lighting lighting = scene.lighting;
        turn_by_frame(lighting.probe, upload.result.geometry().world);
        lighting.probe_up = camera_of(scene.camera).orbit_up;
        if (!lighting.probe.source.empty())
            lighting.loaded_probe = probe.inputs == probe_inputs(lighting) ? probe.result : Probe();
        return held_light(lighting, scene.illumination);
    }

    template <class Upload>
    void show(const Volume& volume, Progress& progress, Upload&& upload_to) {
        const CancelScope scope(progress);
        progress.report("measure", 0);
        Kept<Subject, Version> measured;
        redo("measure", measured, {0}, [&](Subject& studied) {
            studied = volume.placement ? Subject{volume.source, {}, {}} : study(volume, progress);
        });
        subject = std::move(measured.result);
        upload_by(upload_to, progress);
    }

    void show_channels(std::vector<Volume>&& channels, Progress& progress) {
        if (channels.size() > max_channels)
            throw Error(ErrorCode::input, fmt::format("{}: at most {} values a voxel can be shown, not {}",
                                                      channels.front().source, max_channels, channels.size()));
        const Volume& first = channels.front();
        if (first.has_own_colors && channels.size() == 4)
            own_color = first.component_infos.front().name == "alpha" ? OwnColor::by_alpha : OwnColor::by_luminance;
        if (first.has_own_colors && channels.size() == 2) own_color = OwnColor::by_value;
        for (std::size_t i = 1; i < channels.size(); ++i) others.push_back({study(channels[i], progress), {}});
        upload_others(channels, progress);
        show(first, progress,
             [&](const Device& where) { return chiaro::upload(where, std::move(channels.front()), progress); });
        make_alike();
        // What writers put where nothing is known - all white - tells no channel from another.
        const auto has_first_color = [&](const OtherChannel& other) {
            return other.subject.component.rgb == subject.component.rgb;
        };
        if (!std::all_of(others.begin(), others.end(), has_first_color)) return;
        subject.component.rgb.reset();
        for (OtherChannel& other : others) other.subject.component.rgb.reset();
    }

    /// Of the moment that for_moment made this for.
    void show_moment(Volume&& volume, Progress& progress) {
        if (others.empty())
            return upload_by([&](const Device& where) { return chiaro::upload(where, std::move(volume), progress); },
                             progress);
        show_moment(volume, progress);
    }
    void show_moment(const Volume& volume, Progress& progress) {
        std::vector<Volume> channels = components_of(volume);
        upload_others(channels, progress);
        upload_by([&](const Device& where) { return chiaro::upload(where, std::move(channels.front()), progress); },
                  progress);
        make_alike();
    }

    void upload_others(std::vector<Volume>& channels, Progress& progress) {
        for (std::size_t i = 1; i < channels.size(); ++i)
            others[i - 1].volume = chiaro::upload(device, std::move(channels[i]), progress);
    }

    void make_alike() {
        std::vector<DeviceVolume> volumes{upload.result};
        for (const OtherChannel& other : others) volumes.push_back(other.volume);
        volumes = alike(volumes);
        upload.result = volumes.front();
        for (std::size_t i = 1; i < volumes.size(); ++i) others[i - 1].volume = std::move(volumes[i]);
    }

    // Of several channels (session_channels.cpp).
    TransferFunction transfer_of_opacity(const Scene& scene) const;
    Classified in_own_colors(const Scene& scene, const Shape& shape, const Progress& progress) const;
    /// What the scene shows of the channels; of a volume in its own colours what its opacity is found from.
    std::vector<Channel> channels(const Scene& scene) const;
    /// The transfer function of the first, and all of them as one medium.
    Classified classified_channels(const Scene& scene, const Shape& shape, const Progress& progress) const;

    /// With what all moments have in common, and nothing else.
    std::unique_ptr<State> for_moment(const Volume& volume) const {
        const std::size_t values = volume.has_own_colors ? 4 : std::size_t(volume.components);
        if (values != others.size() + 1)
            throw Error(ErrorCode::usage, "channels of several files are shown at one moment: the first");
        if (volume.dimensions != upload.result.dimensions())
            throw Error(ErrorCode::input,
                        fmt::format("moment {} has {} voxels, where the first one has {}", volume.moments.shown,
                                    to_text(volume.dimensions), to_text(upload.result.dimensions())));
        auto moment = std::make_unique<State>(device);
        moment->subject = subject, moment->one_look = one_look, moment->probe = probe;
        moment->own_color = own_color;
        for (const OtherChannel& other : others) moment->others.push_back({other.subject, {}});
        moment->labels = labels, moment->shared_labels = shared_labels, moment->last_version = last_version;
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

    /// Whose values local histograms count.
    const DeviceVolume& counted_volume(const IlluminationSettings& settings) const {
        const int channel = settings.method == Method::histogram ? settings.histogram.channel : 0;
        if (channel > int(others.size()) + 1 || (channel > 1 && own_color != OwnColor::none))
            throw Error(ErrorCode::usage, fmt::format("--hist-channel {}: the volume has {} channel{}", channel,
                                                      own_color != OwnColor::none ? 1 : others.size() + 1,
                                                      others.empty() || own_color != OwnColor::none ? "" : "s"));
        return channel > 1 ? others[std::size_t(channel) - 2].volume : upload.result;
    }

    /// The stages that pictures and fields have in common.
    void redo_up_to_classify(const Scene& scene, Progress& progress) {
        begin();
        const DeviceVolume& voxels = counted_volume(scene.illumination);
        redo("prepare", prepare, {upload.version, preparation_of(scene.illumination)},
             [&](Prepared& prepared) { prepared = chiaro::prepare(device, voxels, scene.illumination, progress); });
        tell_steps(prepare.result.stages());
        progress.check();
        redo_classify(scene, progress);
    }

    /// What the scene's labels make of the volume; null: it has none. Names it among the inputs of what follows.
    std::pair<std::shared_ptr<const LabelBricks>, Version> redo_labels(const Scene& scene, Progress& progress) {
        if (!scene.labels.any()) return {};
        redo("labels", labels, {SharedLabels::key_of(scene)},
             [&](std::shared_ptr<const LabelVolume>& read) { read = shared_labels->find(scene, progress); });
        redo("borders", labelled, {upload.version, labels.version, scene.labels.changes, scene.output.color},
             [&](std::shared_ptr<const LabelBricks>& bricks) {
                 const auto& read = labels.result;
                 bricks = borders.find(read, with_changes(read->labels, scene.labels.changes), upload.result,
                                       scene.output.color, device.threads, progress);
             });
        return {labelled.result, labelled.version};
    }

    /// Names what redo_labels made for the scene; 0: none, or it would be other ones.
    Version labels_of(const Scene& scene) const {
        const bool is_kept =
            labels.inputs == std::make_tuple(SharedLabels::key_of(scene)) &&
            labelled.inputs == std::tuple(upload.version, labels.version, scene.labels.changes, scene.output.color);
        return is_kept && scene.labels.any() ? labelled.version : 0;
    }

    void redo_classify(const Scene& scene, Progress& progress) {
        const Shape shape = shape_for(scene);
        const auto [bricks, labels_version] = redo_labels(scene, progress);
        const std::tuple inputs(upload.version, scene.transfer, scene.channels, shape, labels_version);
        if (gave_back && (classify.inputs != inputs || !looks_at_visible_voxels(scene)))
            throw Error(ErrorCode::internal, "a session of one look was asked for another");
        redo("classify", classify, inputs, [&](Classified& classified) {
            if (!others.empty() || !scene.channels.empty()) {
                classified = own_color == OwnColor::none ? classified_channels(scene, shape, progress)
                                                         : in_own_colors(scene, shape, progress);
                classified.medium = with_labels(device, classified.medium, bricks, progress);
                return;
            }
            classified.tf = are_labels_alone(scene) ? of_labels_alone(scene.transfer, subject)
                                                    : transfer_function_for(scene.transfer, subject);
            if (refiner) classified.tf = of_finest_voxels(classified.tf, refiner->finest());
            classified.medium = with_labels(
                device, chiaro::classify(device, upload.result, classified.tf, shape, progress), bricks, progress);
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
        if (gave_back || !one_look || refiner || !looks_at_visible_voxels(scene)) return;
        discard_unseen(medium);
        gave_back = true;
    }

    /// Names the medium that redo_interpolate made for the scene; 0: it would be another.
    Version medium_version(const Scene& scene) const {
        if (!has_finer_interpolation(scene)) return classify.version;
        return interpolate.inputs == std::tuple(classify.version, scene.interpolation) ? interpolate.version : 0;
    }

    auto opacities_of(const Scene& scene) const {
        return std::tuple(upload.version, without_colors(scene.transfer), scene.channels, shape_for(scene),
                          labels_of(scene),
                          has_finer_interpolation(scene) ? scene.interpolation : Interpolation::linear);
    }
    /// Names what light is found in, of a medium that is there: its opacities, where colours make no difference.
    Version matter_version(const Scene& scene) const {
        if (!sees_opacities_alone(scene.illumination)) return medium_version(scene);
        return opacities.inputs == opacities_of(scene) ? opacities.version : 0;
    }

    /// What is handed on of each coarse light: a picture, of which the first is a draft (linear, where drafts are); or
    /// drafts alone, which take a quarter of the time at most.
    enum class OfCoarseLight { pictures, drafts };

    // Light, and drafts in it (session_light.cpp).
    void redo_illuminate(const Scene& scene, const Camera& camera, const Lighting& lighting, Progress& progress,
                         const Preview& preview, OfCoarseLight what = OfCoarseLight::pictures);
    bool has_one_value(const Scene& scene) const {
        return others.empty() && scene.channels.empty() && !scene.labels.any();
    }
    bool is_lit_soon(const Scene& scene) const {
        return has_one_value(scene) && is_soon_lit(upload.result, scene.illumination);
    }
    void redo_soon(const Scene& scene, const Lighting& lighting, Progress& progress);
    bool may_show_every_other_voxel(const Scene& scene) const;
    const Image* draw_every_other_voxel(const Scene& scene, Progress& progress);
    const Image& draw_draft(const Scene& scene, const IlluminationField& field, const Lighting& lighting,
                            const Camera& camera, Progress& progress);

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

}  // namespace chiaro
