#include <chiaro/session.h>

#include "classify/medium.h"
#include "core/threads.h"
#include "render/appearance.h"

namespace chiaro {

namespace {

/// Of a later moment the range, the look and what the camera fits are the first one's.
Image render_later_moment(const Device& device, const Scene& scene, Progress& progress) {
    Session session(device);
    Scene moment = scene;
    moment.read.time = 0;
    session.show(read_volume(moment, progress), progress);
    moment.camera = session.fit(moment, progress);
    moment.read.time = scene.read.time;
    session.show_moment(read_volume(moment, progress), progress);
    return session.render(moment, progress);
}

Image render_channels(const Device& device, const Scene& scene, std::vector<Volume>&& channels, Progress& progress) {
    Session session(device);
    session.show(std::move(channels), progress);
    return session.render(scene, progress);
}

}  // namespace

Image render_image(const Device& device, const Scene& scene, Progress& progress) {
    const CancelScope scope(progress);
    if (scene.read.time > 0) return render_later_moment(device, scene, progress);

    // What is shown, and what its values mean.
    std::vector<Volume> channels = read_channels(scene, progress);
    if (channels.size() > 1 || !scene.channels.empty())
        return render_channels(device, scene, std::move(channels), progress);
    Volume volume = std::move(channels.front());
    const Subject subject = study(volume, progress);
    const Geometry geometry = volume.geometry;
    const auto dimensions = volume.dimensions;

    // What depends on the data alone.
    const DeviceVolume voxels = upload(device, std::move(volume), progress);
    const Prepared prepared = prepare(voxels, scene.illumination, progress);

    // What it looks like.
    const TransferFunction tf = transfer_function_for(scene.transfer, subject);
    Medium medium = classify(device, voxels, tf, shape_for(scene), progress);

    if (has_finer_interpolation(scene))
        medium = finely_interpolated(device, medium, scene, subject.statistics.noise, progress);

    // What lights it.
    const Camera camera =
        make_camera(fit_camera(device, medium, scene.camera, scene.sampling, scene.width, scene.height, progress),
                    geometry, dimensions);
    if (looks_at_visible_voxels(scene)) discard_unseen(medium);  // no other will be asked for
    Lighting lighting = with_probe(scene.lighting);
    turn_by_frame(lighting.probe, geometry.world);
    lighting.probe_up = camera.orbit_up;

    // How much light arrives where: the last field is the finest.
    IlluminationField field;
    const auto keep = [&](IlluminationField finer) { field = std::move(finer); };
    illuminate(device, medium, prepared, lighting, scene.illumination, keep, progress);
    progress.check();

    // What the camera sees of it.
    DeviceFrame frame(scene.width, scene.height);
    if (is_path_traced(scene.illumination))
        trace_paths(device, medium, lighting, camera, scene.sampling, scene.illumination, frame, progress);
    else
        raycast(device, medium, field, lighting, camera, scene.sampling, frame, progress);
    progress.check();

    return develop(frame, scene.output);
}

}  // namespace chiaro
