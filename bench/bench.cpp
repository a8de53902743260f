#include "bench.h"

#include <chiaro/error.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/did_you_mean.h"

namespace chiaro::bench {
namespace {

constexpr auto suite_table = std::to_array<Suite>({
    {"memory", "copying and reading: what the machine's memory gives", memory_cases},
    {"sampling", "ray casting without skipping: types, directions, instruction sets", sampling_cases},
    {"skipping", "what empty-space skipping saves", skipping_cases},
    {"channels", "a frame of several channels", channel_cases},
    {"labels", "a frame with labels", label_cases},
    {"lit", "a frame in light that is there, by each method", lit_cases},
    {"paging", "volumes by bricks: a frame beside one of the whole, reading, pictures of ever larger ones",
     paging_cases},
    {"scenes", "a frame of each scene of bench/scenes", scene_cases},
    {"ways", "the same scenes as isosurfaces and maxima, classified, composited and set up in other ways", way_cases},
    {"pipeline", "upload and classify", pipeline_cases},
    {"moments", "a series through time is played: reading, classifying, light, frames, and what is waited for",
     moment_cases},
    {"spao", "ambient occlusion by filtering: the published table, and an edit's update", spao_cases},
    {"spao-error", "ambient occlusion by filtering against rays: error of every model and filter", spao_error_cases},
    {"visibility", "visibility in spherical harmonics: the published table, and an edit's update", visibility_cases},
    {"transport", "multiple scattering: its sweeps, and an edit's way to light", transport_cases},
    {"visibility-error", "visibility in spherical harmonics against rays: error of every way", visibility_error_cases},
    {"transport-error", "multiple scattering against light's own paths: mean radiance and pictures",
     transport_error_cases},
    {"transport-strip", "the same pictures side by side, written where CHIARO_STRIP_DIR says", transport_strip_cases},
    {"paths", "the path tracer: a frame of one path a pixel, and what majorants by region save", path_cases},
    {"path-noise", "how sure its pixels are: those far off (minutes a scene), and the time to 2 %", path_noise_cases},
    {"histogram", "local histograms: the published table of preprocessing, an edit's table, errors of occlusion",
     histogram_cases},
    {"gpu", "frames on a GPU by the clock (--device cuda), and what its memory gives", gpu_cases},
    {"cancel", "how long a call goes on after it was cancelled", cancel_cases},
    {"tool", "first picture and peak memory of the program itself", tool_cases},
});

void check_suites(const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const Suite& suite : suite_table) known.emplace_back(suite.name);
    for (const auto& name : names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw Error(ErrorCode::usage, "unknown benchmark '" + name + "'" + did_you_mean(name, known));
}

std::regex filter_of(const std::string& text) {
    try {
        return std::regex(text);
    } catch (const std::regex_error&) {
        throw Error(ErrorCode::usage, "--filter " + text + ": is not a regular expression");
    }
}

}  // namespace

std::span<const Suite> suites() { return suite_table; }

void run(const Setup& setup, const Selection& selection, const std::function<void(const Row&)>& found) {
    check_suites(selection.suites);
    const std::regex filter = filter_of(selection.filter);
    const auto is_wanted = [&](const std::string& name) { return std::regex_search(name, filter); };
    for (const Suite& suite : suite_table) {
        const auto& names = selection.suites;
        if (!names.empty() && std::find(names.begin(), names.end(), suite.name) == names.end()) continue;
        for (Case& each : suite.cases(setup)) {
            const Case current = std::exchange(each, {});  // what cases share goes with the last that needs it
            if (std::none_of(current.names.begin(), current.names.end(), is_wanted)) continue;
            setup.progress.check();
            for (Row& row : current.measure()) {
                if (!is_wanted(row.name)) continue;
                if (!setup.quick) row.beside = beside(row.name);
                found(row);
            }
        }
    }
}

}  // namespace chiaro::bench
