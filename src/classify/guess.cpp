// What kind of data is this? Rules of thumb, in the order of how much they can be trusted; the reason is told to the
// user so that a wrong guess can be put right.
#include <chiaro/samples.h>
#include <chiaro/transfer_function.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "classify/largest.h"

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

/// Vessels full of contrast medium after all else was subtracted: nearly all is dark, the rest as bright as can be.
bool is_sparse_and_bright(const Statistics& data) {
    const double range = data.max - data.min;
    return data.p99 <= data.min + 0.01 * range && data.p999 >= data.min + 0.5 * range;
}

/// A density that thins out: from its background the histogram only falls. Solid matter has a peak of its own.
bool only_falls(const Statistics& data) {
    constexpr int bins = 256, half = 4;
    std::array<double, bins> smooth{};
    double total = 0;
    for (int i = 0; i < bins; ++i)
        for (int j = std::max(0, i - half); j <= std::min(bins - 1, i + half); ++j)
            smooth[std::size_t(i)] += double(data.histogram[std::size_t(j)]);
    for (const auto count : data.histogram) total += double(count);
    if (total == 0) return false;
    const auto top = std::max_element(smooth.begin(), smooth.end());
    double least = *top;
    for (auto at = top; at != smooth.end() - half; ++at) {
        least = std::min(least, *at);
        if (*at > 1.5 * least && *at > 0.002 * total) return false;
    }
    return true;
}

/// The words of a file's name and header, in lower case.
std::set<std::string> words_of(const Volume& volume) {
    std::string text = std::filesystem::path(volume.source).filename().string();
    for (const auto& [key, value] : volume.key_values) text += " " + value;
    std::set<std::string> words;
    std::string word;
    for (const char c : text + " ") {
        const bool is_letter = std::isalnum(static_cast<unsigned char>(c));
        if (is_letter) word += char(std::tolower(static_cast<unsigned char>(c)));
        if (!is_letter && !word.empty()) words.insert(std::exchange(word, ""));
    }
    return words;
}

struct Hint {
    std::string_view word, modality, preset;
};
/// What people call their files.
constexpr Hint hints[] = {{"t2", "MR", "mr-t2-brain"},
                          {"fetal", "MR", "mr-t2-brain"},
                          {"foetal", "MR", "mr-t2-brain"},
                          {"angio", "angiography", "mr-angio"},
                          {"mra", "angiography", "mr-angio"},
                          {"tof", "angiography", "mr-angio"},
                          {"fa", "MR", "dti-fa-brain"},
                          {"pet", "PT", "pet"},
                          {"suv", "PT", "pet"},
                          {"ultrasound", "US", "us-fetal"},
                          {"fluorescence", "microscopy", "fluorescence"},
                          {"confocal", "microscopy", "fluorescence"},
                          {"gfp", "microscopy", "fluorescence"},
                          {"dapi", "microscopy", "fluorescence"}};

/// A hint that agrees with what else is known (an empty modality: with anything).
std::optional<Guess> from_words(const Volume& volume, std::string_view modality) {
    const auto words = words_of(volume);
    for (const Hint& hint : hints)
        if (words.contains(std::string(hint.word)) && (modality.empty() || hint.modality == modality))
            return Guess{std::string(hint.modality), std::string(hint.preset),
                         fmt::format("it is called '{}'", hint.word)};
    return {};
}

Guess without_rescale(const Statistics& data, const std::string& why) {
    if (data.hu_zero > 0)
        return {
            "CT", "ct-bone",
            fmt::format("{} of {}, air at {:g}: HU + {:g}", why, range_text(data), data.hu_zero - 1000, data.hu_zero)};
    return {"CT", "micro-ct", why + " of " + range_text(data) + " but no rescale to HU (--rescale 1,-1024 is common)"};
}

Guess from_header(const Volume& volume, const Statistics& data) {
    const std::string says = "the file says " + volume.modality;
    if (volume.modality == "MR") {
        const auto hint = from_words(volume, "MR");
        return hint ? Guess{"MR", hint->preset, says + ", and " + hint->reason} : Guess{"MR", "mr-brain", says};
    }
    if (volume.modality == "PT" || volume.modality == "NM") return {volume.modality, "pet", says};
    if (volume.modality == "RTDOSE") return {volume.modality, "simulation", says};
    if (volume.modality == "XA") return {volume.modality, "mr-angio", says};
    if (volume.modality == "US") return {volume.modality, "us-fetal", says};
    if (volume.modality != "CT") return {volume.modality, "micro-ct", says};
    return looks_like_hu(volume, data) ? Guess{"CT", "ct-bone", says + ", in HU"}
                                       : without_rescale(data, says + " with values");
}

Guess from_values(const Volume& volume, const Statistics& data) {
    const bool anatomical = volume.geometry.world != World::unknown, is_8_bit = size_of(volume.type) == 1;
    const std::string type(name_of(volume.type));
    if (looks_like_hu(volume, data)) return {"CT", "ct-bone", "values of " + range_text(data) + " look like HU"};
    if (data.max <= data.min) return {"simulation", "simulation", "all values are the same"};
    if (data.hu_zero > 0 || looks_like_unscaled_ct(volume, data)) return without_rescale(data, "16 bit values");
    if (const auto hint = from_words(volume, "")) return *hint;
    if (is_sparse_and_bright(data))
        return {"angiography", "mr-angio", "99 % of the values are next to nothing, the rest is bright"};
    if (is_float(volume.type) && !anatomical)
        return {"simulation", "simulation", type + " without an anatomical frame"};
    if (anatomical && (!is_8_bit || has_bright_plateau(data)))
        return {"MR", "mr-brain", type + " in an anatomical frame, " + range_text(data) + ", no HU"};
    if (anatomical) return {"CT", "ct-8bit", "8 bit values of " + range_text(data) + " in an anatomical frame"};
    if (only_falls(data)) {
        const std::string why = "from the background on values only grow rarer, as of a density";
        if (volume.format == "TIFF") return {"microscopy", "fluorescence", "a stack of TIFF; " + why};
        if (is_8_bit) return {"simulation", "simulation", why};
    }
    if (is_8_bit) return {"micro-CT", "micro-ct", "8 bit values of " + range_text(data)};
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

double detached_share(const Volume& volume, const Statistics& data) {
    if (volume.components != 1 || (data.hu_zero == 0 && !looks_like_hu(volume, data))) return 0;
    const int stride = 1 + int(std::cbrt(double(volume.voxel_count()) / (256.0 * 256 * 256)) > 1);
    const auto& n = volume.dimensions;
    const std::array<int, 3> count{(n[0] - 1) / stride + 1, (n[1] - 1) / stride + 1, (n[2] - 1) / stride + 1};
    const std::size_t all_voxels = std::size_t(count[0]) * count[1] * count[2];
    std::vector<std::uint8_t> dense(all_voxels);
    with_voxel_type(volume.type, [&](auto zero) {
        const auto voxels = volume.as<decltype(zero)>();
        std::size_t to = 0;
        for (int z = 0; z < n[2]; z += stride)
            for (int y = 0; y < n[1]; y += stride)
                for (int x = 0; x < n[0]; x += stride) {
                    const auto stored = voxels[(std::size_t(z) * n[1] + y) * n[0] + x];
                    dense[to++] = volume.slope * double(stored) + volume.intercept - data.hu_zero > -500;
                }
    });
    const Pieces pieces = find_pieces(dense, count);
    const auto all = double(std::count(dense.begin(), dense.end(), 1));
    return all > 0 ? 1 - double(pieces.largest) / all : 0;
}

}  // namespace chiaro
