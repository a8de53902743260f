#include <chiaro/error.h>
#include <fmt/format.h>

#include <span>

#include "core/did_you_mean.h"
#include "core/threads.h"
#include "samples/sample.h"

namespace chiaro {
namespace {

std::vector<Sample> samples() {
    return {cornell_sample(),   marschner_lobb_sample(), shells_sample(), fog_sample(),   slab_sample(),  ball_sample(),
            halfspace_sample(), tubes_sample(),          menger_sample(), torso_sample(), organs_sample()};
}

}  // namespace

Sample sample_named(const std::string& name) {
    std::vector<std::string> names;
    for (const Sample& sample : samples()) {
        if (sample.info.name == name) return sample;
        names.push_back(sample.info.name);
    }
    std::string list;
    for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
    const std::string hint = did_you_mean(name, names);
    throw Error(ErrorCode::usage, "unknown sample '" + name + "'" + (hint.empty() ? ": must be one of " + list : hint));
}

std::vector<SampleInfo> list_samples() {
    std::vector<SampleInfo> infos;
    for (const Sample& sample : samples()) infos.push_back(sample.info);
    return infos;
}

Volume make_sample(const std::string& name, int size) {
    Progress progress;
    return make_sample(name, size, progress);
}

Volume sample_header(const Sample& sample, int size, int most) {
    const std::string& name = sample.info.name;
    if (size == 0) size = sample.info.default_size;
    if (size < 2 || size > most)
        throw Error(ErrorCode::usage, fmt::format("size {} of sample '{}': must be in 2..{}", size, name, most));
    Volume volume;
    volume.dimensions = {size, size, size};
    volume.type = sample.voxels(2).type;
    volume.source = "sample:" + name;
    volume.format = "sample";
    volume.key_values["chiaro_sample"] = name;  // travels in a written file, so that its look is found again
    if (sample.place) sample.place(volume);
    return volume;
}

Volume make_sample(const std::string& name, int size, Progress& progress) {
    const Sample sample = sample_named(name);
    Volume volume = sample_header(sample, size, 4096);
    const auto [nx, ny, nz] = volume.dimensions;
    const SampleVoxels voxels = sample.voxels(nx);
    const std::size_t slice = std::size_t(nx) * ny * size_of(volume.type);
    volume.voxels = VoxelBuffer(slice * nz);
    std::byte* to = volume.voxels.data();
    const std::array<int, 3> one_slice{nx, ny, 1};
    parallel_for(usable_threads(), nz, 1, "sample", progress, [&](std::int64_t first, std::int64_t last) {
        for (auto k = first; k < last; ++k) voxels.fill({{0, 0, int(k)}, one_slice}, to + std::size_t(k) * slice);
    });
    progress.check();
    return volume;
}

TransferFunction sample_transfer_function(const std::string& name) {
    TransferFunction tf = sample_named(name).transfer_function();
    tf.name = "sample:" + name;
    return tf;
}

}  // namespace chiaro
