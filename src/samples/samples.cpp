#include <chiaro/error.h>

#include <span>

#include "core/did_you_mean.h"
#include "samples/sample.h"

namespace chiaro {
namespace {

std::vector<Sample> samples() {
    return {cornell_sample(), marschner_lobb_sample(), shells_sample(), fog_sample(),    slab_sample(),
            ball_sample(),    halfspace_sample(),      tubes_sample(),  menger_sample(), torso_sample()};
}

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

}  // namespace

std::vector<SampleInfo> list_samples() {
    std::vector<SampleInfo> infos;
    for (const Sample& sample : samples()) infos.push_back(sample.info);
    return infos;
}

Volume make_sample(const std::string& name, int size) {
    Progress progress;
    return make_sample(name, size, progress);
}

Volume make_sample(const std::string& name, int size, Progress& progress) {
    const Sample sample = sample_named(name);
    if (size == 0) size = sample.info.default_size;
    if (size < 2 || size > 4096)
        throw Error(ErrorCode::usage, "size " + std::to_string(size) + " of sample '" + name + "': must be in 2..4096");
    Volume volume = sample.make(size, progress);
    volume.source = "sample:" + name;
    volume.format = "sample";
    volume.key_values["chiaro_sample"] = name;  // travels in a written file, so that its look is found again
    return volume;
}

TransferFunction sample_transfer_function(const std::string& name) {
    TransferFunction tf = sample_named(name).transfer_function();
    tf.name = "sample:" + name;
    return tf;
}

}  // namespace chiaro
