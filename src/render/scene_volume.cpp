#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>
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
    scene.camera.by_frame = scene.lighting.probe.by_frame = true;
    for (const SampleInfo& sample : list_samples()) {
        const std::string name = "sample:" + sample.name;
        if (sample.names_materials && (volume == name || volume.starts_with(name + ":")))
            scene.sampling.classification = Classification::pre;
    }
    return scene;
}

void stand_by_frame(Scene& scene, World world) {
    look_from(scene.camera, world);
    turn_by_frame(scene.lighting.probe, world);
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

std::vector<ChannelSettings> channels_of(const Scene& scene, int components) {
    std::vector<ChannelSettings> own, files;
    for (const ChannelSettings& channel : scene.channels) (channel.file.empty() ? own : files).push_back(channel);
    if (int(own.size()) > components)
        throw Error(ErrorCode::input, fmt::format("channels: {} are of the volume itself, which has {} value{} a voxel",
                                                  own.size(), components, components > 1 ? "s" : ""));
    own.resize(std::size_t(components));
    own.insert(own.end(), files.begin(), files.end());
    if (own.size() > max_channels)
        throw Error(ErrorCode::input,
                    fmt::format("at most {} channels can be shown, not {}", max_channels, own.size()));
    for (std::size_t i = 0; i < own.size(); ++i)
        if (own[i].name.empty()) own[i].name = fmt::format("channel {}", i + 1);
    return own;
}

std::vector<Volume> read_channels(const Scene& scene, Progress& progress) {
    Volume first = read_volume(scene, progress);
    channels_of(scene, first.components);  // refuses what is too many before it is taken apart
    if (first.has_own_colors && !scene.channels.empty())
        throw Error(ErrorCode::usage,
                    fmt::format("{}: in its own colours a volume has no channels beside it, and none to set: "
                                "--channels-as channels shows its values as such",
                                first.source));
    std::vector<Volume> all;
    if (first.components == 1)
        all.push_back(std::move(first));
    else
        all = components_of(first), first = Volume();
    for (const ChannelSettings& channel : scene.channels) {
        if (channel.file.empty()) continue;
        Volume volume = read_volume(channel.file, {.private_addresses = scene.read.private_addresses}, progress);
        if (volume.components > 1)
            throw Error(ErrorCode::input, fmt::format("{}: has {} values a voxel, where a channel has one",
                                                      volume.source, volume.components));
        if (!has_grid_of(volume, all.front())) {
            const std::string note = fmt::format("resampled from {} voxels onto the volume's {}",
                                                 to_text(volume.dimensions), to_text(all.front().dimensions));
            volume = resampled(volume, all.front());
            volume.notes.push_back(note);
        }
        all.push_back(std::move(volume));
    }
    return all;
}

std::shared_ptr<const BrickSource> paged_volume(const Scene& scene, const PagingSettings& settings) {
    if (!scene.channels.empty()) return nullptr;
    if (scene.stated.spacing_mm || scene.volume == "-" || !moment_files(scene.volume).empty()) return {};
    auto source = open_brick_source(scene.volume, scene.read);
    if (!source) {
        if (settings.finest_level > 0)
            throw Error(
                ErrorCode::usage,
                fmt::format(
                    "--level {}: {} is read as a whole; samples are not, nor OME-Zarr, HDF5, TIFF, OpenVDB, and raw, "
                    "NRRD, MetaImage, NIfTI and VTK files whose voxels are not compressed",
                    settings.finest_level, scene.volume));
        return {};
    }
    if (fits(*source, settings)) return {};
    const int levels = int(source->levels().size());
    if (settings.finest_level >= levels)
        throw Error(ErrorCode::usage,
                    fmt::format("--level {}: {} has levels 0 to {}", settings.finest_level, scene.volume, levels - 1));
    const auto& stated = scene.stated.dimensions;
    if (stated && *stated != source->header().dimensions) return {};  // read_volume says so
    return source;
}

LabelVolume read_labels(const Scene& scene, Progress& progress) {
    ReadOptions options{.private_addresses = scene.read.private_addresses};
    if (scene.labels.source == scene.volume) options = scene.read;
    options.time = 0;
    LabelVolume labels;
    if (const auto& loaded = scene.labels.loaded) {
        labels.dimensions = loaded->dimensions, labels.geometry = loaded->geometry;
        labels.labels = loaded->labels, labels.counts = loaded->counts;
        labels.source = loaded->source, labels.notes = loaded->notes;
        labels.voxels = VoxelBuffer::borrow(loaded->voxels.data(), loaded->voxels.size(), loaded);
    } else {
        labels = read_labels(scene.labels.source, scene.labels.table, options, progress);
    }
    if (are_labels_alone(scene)) labels.labels.front().show = false;
    return labels;
}

bool are_labels_alone(const Scene& scene) {
    return !scene.labels.source.empty() && scene.labels.source == scene.volume;
}

}  // namespace chiaro
