// Light of a session, and drafts in it.
#include "render/session_state.h"

namespace chiaro {

void Session::State::redo_illuminate(const Scene& scene, const Camera& camera, const Lighting& lighting,
                                     Progress& progress, const Preview& preview, OfCoarseLight what) {
    if (auto now = opacities_of(scene); opacities.inputs != now)
        opacities.inputs = std::move(now), opacities.version = ++last_version;
    using Clock = std::chrono::steady_clock;
    redo("illuminate", illuminate,
         {matter_version(scene), prepare.version, scene.illumination, held_light(lighting, scene.illumination)},
         [&](IlluminationField& field) {
             const IlluminationField warm = field;
             bool is_draft = has_linear_drafts(scene);
             Clock::time_point next{};
             const auto keep = [&](IlluminationField finer) {
                 field = std::move(finer);
                 const auto start = Clock::now();
                 if (!preview || !field.is_coarse() || start < next) return;
                 DeviceFrame frame(scene.width, scene.height);
                 chiaro::raycast(device, is_draft ? classify.result.medium : medium, field, lighting, camera,
                                 scene.sampling, frame, progress);
                 if (!progress.cancelled()) preview(chiaro::develop(frame, scene.output));
                 if (what == OfCoarseLight::pictures)
                     is_draft = false;
                 else
                     next = Clock::now() + 3 * (Clock::now() - start);
             };
             chiaro::illuminate(device, medium, prepare.result, lighting, scene.illumination, keep, progress, warm);
             progress.check();
         });
    tell_steps(illuminate.result.stages());
}

/// Every other voxel, and its own light.
void Session::State::redo_soon(const Scene& scene, const Lighting& lighting, Progress& progress) {
    const Shape shape = shape_for(scene);
    redo("every other voxel", every_other, {upload.version},
         [&](DeviceVolume& volume) { volume = every_other_voxel(upload.result, progress); });
    redo("classify", every_other_medium, {every_other.version, scene.transfer, shape}, [&](Medium& made) {
        const TransferFunction tf = of_finest_voxels(transfer_function_for(scene.transfer, subject), finest());
        made = chiaro::classify(device, every_other.result, tf, shape, progress);
    });
    redo("illuminate", soon, {every_other.version, without_colors(scene.transfer), shape, scene.illumination},
         [&](IlluminationField& field) {
             field =
                 light_of_every_other_voxel(device, every_other_medium.result, lighting, scene.illumination, progress);
         });
    tell_steps(soon.result.stages());
}

/// Whether a draft needs no more than every other voxel of a large volume: samples are two voxels apart, and where the
/// camera looks a pixel is no smaller than a voxel.
bool Session::State::may_show_every_other_voxel(const Scene& scene) const {
    if (refiner || !has_one_value(scene) || !is_large(upload.result)) return false;
    const bool is_coarse = scene.sampling.step_voxels >= 2 && looks_at_visible_voxels(scene);
    // A piece may hold together by one voxel.
    if (!is_coarse || !is_fitted(scene.camera) || scene.clip.largest) return false;
    const Camera seen_from = camera_of(scene.camera);
    const double depth = seen_from.projection == Projection::orthographic ? 1 : seen_from.focus_mm;
    return 2 * seen_from.half_height * depth / scene.height >= upload.result.geometry().smallest_spacing_mm();
}

/// In its own light; null where it may not be, or opacity goes by gradient, which from voxel to voxel is another.
const Image* Session::State::draw_every_other_voxel(const Scene& given, Progress& progress) {
    if (!may_show_every_other_voxel(given)) return nullptr;
    begin();
    camera = fitted(given, 0, progress);  // as it is given
    const Camera seen_from = camera_of(camera);
    const Lighting lighting = lighting_of(given, seen_from);
    redo_soon(given, lighting, progress);
    if (every_other_medium.result.data().volume.data().factor) return nullptr;
    medium = every_other_medium.result;
    Scene scene = given;
    scene.sampling.step_voxels /= 2;
    return &draw_draft(scene, soon.result, lighting, seen_from, progress);
}

/// Of `medium`.
const Image& Session::State::draw_draft(const Scene& scene, const IlluminationField& field, const Lighting& lighting,
                                        const Camera& seen_from, Progress& progress) {
    DeviceFrame& frame = previewed.frame;
    frame.resize(scene.width, scene.height);
    timed("raycast", [&] {
        IlluminationSettings settings = scene.illumination;
        settings.reference.rays = 1;
        const Drawing drawing{device, medium, field, lighting, seen_from, scene, frame, previewed.render_statistics};
        if (refiner && refiner->draw_what_is_there(drawing, progress)) return progress.check();
        previewed.render_statistics =
            is_path_traced(settings)
                ? trace_paths(device, medium, lighting, seen_from, scene.sampling, settings, frame, progress)
                : chiaro::raycast(device, medium, field, lighting, seen_from, scene.sampling, frame, progress);
        progress.check();
    });
    timed("develop", [&] { previewed_image = chiaro::develop(frame, scene.output); });
    return previewed_image;
}

}  // namespace chiaro
