// What kind of data is this? Rules of thumb, in the order of how much they can be trusted; the reason is told to the
// user so that a wrong guess can be put right.
#include <chiaro/samples.h>
#include <chiaro/transfer_function.h>
#include <fmt/format.h>

namespace chiaro {
namespace {

std::string range_text(const Statistics& data) { return fmt::format("{:.6g}..{:.6g}", data.min, data.max); }

bool is_float(VoxelType type) { return type == VoxelType::f32 || type == VoxelType::f64; }

/// Air is -1000 HU; what pads a CT lies at -1024, -2000, -3024 or so.
bool looks_like_hu(const Volume& volume, const Statistics& data) {
    const bool shifted = volume.intercept <= -900 && volume.intercept >= -1100;
    return data.min <= -900 && data.min >= -4096 && data.max > 100 && data.max <= 32767 &&
           (shifted || !is_float(volume.type) || data.min >= -1100);
}

/// 12 bit scanners count from 0 (air at 24 or so) to 4095.
bool looks_like_unscaled_ct(const Volume& volume, const Statistics& data) {
    return size_of(volume.type) == 2 && data.min >= 0 && data.max <= 4095 && data.max > 3000;
}

/// The brain's white matter is a broad plateau at the upper end, where CT has bone and metal: a long thin tail.
bool has_bright_plateau(const Statistics& data) { return data.p99 > 0 && data.p999 < 1.1 * data.p99; }

Guess without_rescale(const Statistics& data, const std::string& why) {
    return {"CT", "micro-ct", why + " of " + range_text(data) + " but no rescale to HU (--rescale 1,-1024 is common)"};
}

Guess from_header(const Volume& volume, const Statistics& data) {
    const std::string says = "the file says " + volume.modality;
    if (volume.modality == "MR") return {"MR", "mr-brain", says};
    if (volume.modality == "PT" || volume.modality == "NM" || volume.modality == "RTDOSE")
        return {volume.modality, "simulation", says};
    if (volume.modality != "CT") return {volume.modality, "micro-ct", says};
    return looks_like_hu(volume, data) ? Guess{"CT", "ct-bone", says + ", in HU"}
                                       : without_rescale(data, says + " with values");
}

Guess from_values(const Volume& volume, const Statistics& data) {
    const bool anatomical = volume.geometry.world != World::unknown;
    const std::string type(name_of(volume.type));
    if (looks_like_hu(volume, data)) return {"CT", "ct-bone", "values of " + range_text(data) + " look like HU"};
    if (looks_like_unscaled_ct(volume, data)) return without_rescale(data, "16 bit values");
    if (is_float(volume.type) && !anatomical)
        return {"simulation", "simulation", type + " without an anatomical frame"};
    if (anatomical && (size_of(volume.type) > 1 || has_bright_plateau(data)))
        return {"MR", "mr-brain", type + " in an anatomical frame, " + range_text(data) + ", no HU"};
    if (size_of(volume.type) == 1) return {"micro-CT", "micro-ct", "8 bit values of " + range_text(data)};
    return {"micro-CT", "micro-ct", type + " values of " + range_text(data) + " without a known unit"};
}

}  // namespace

Guess guess(const Volume& volume, const Statistics& data) {
    const auto sample = volume.key_values.find("chiaro_sample");
    if (sample != volume.key_values.end()) {
        for (const SampleInfo& known : list_samples())
            if (known.name == sample->second) return {"sample", "sample:" + known.name, "a sample of Chiaro"};
    }
    return volume.modality.empty() ? from_values(volume, data) : from_header(volume, data);
}

}  // namespace chiaro
