#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/scene.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "render/appearance.h"

namespace chiaro {
namespace {

void check_against(const ExpectedVolume& stated, const Volume& volume) {
    if (stated.dimensions && *stated.dimensions != volume.dimensions)
        throw Error(ErrorCode::input, fmt::format("{}: holds {} voxels, where the scene states {}", volume.source,
                                                  to_text(volume.dimensions), to_text(stated.dimensions)));
    if (stated.type && *stated.type != volume.type)
        throw Error(ErrorCode::input, fmt::format("{}: holds {} voxels, where the scene states {}", volume.source,
                                                  to_text(volume.type), to_text(stated.type)));
}

}  // namespace

Scene scene_of_volume(const std::string& volume) {
    Scene scene;
    scene.volume = volume;
    scene.camera.by_frame = true;
    for (const SampleInfo& sample : list_samples()) {
        const std::string name = "sample:" + sample.name;
        if (sample.names_materials && (volume == name || volume.starts_with(name + ":")))
            scene.sampling.classification = Classification::pre;
    }
    return scene;
}

Volume read_volume(const Scene& scene, Progress& progress) {
    Volume volume = read_volume(scene.volume, scene.read, progress);
    check_against(scene.stated, volume);
    Vec3& spacing = volume.geometry.spacing_mm;
    if (const auto& stated = scene.stated.spacing_mm; stated && *stated != spacing) {
        if (spacing != Vec3{1, 1, 1})
            volume.notes.push_back(fmt::format("the scene's spacing of {} mm replaces the file's {} mm",
                                               to_text(stated), to_text(spacing)));
        spacing = *stated;
    }
    return volume;
}

LabelVolume read_labels(const Scene& scene, Progress& progress) {
    ReadOptions options;
    if (scene.labels.source == scene.volume) options = scene.read;
    options.time = 0;
    LabelVolume labels = read_labels(scene.labels.source, scene.labels.table, options, progress);
    if (are_labels_alone(scene)) labels.labels.front().show = false;
    return labels;
}

bool are_labels_alone(const Scene& scene) {
    return !scene.labels.source.empty() && scene.labels.source == scene.volume;
}

}  // namespace chiaro
