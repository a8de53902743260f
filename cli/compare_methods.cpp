#include "compare_methods.h"

#include <chiaro/comparison.h>
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>

#include "method_page.h"
#include "method_report.h"
#include "output_file.h"

namespace chiaro::cli {
namespace {

/// All that were named but the reference, which is there in any case.
std::vector<Method> methods_in(const std::string& names) {
    std::vector<Method> methods;
    for (std::size_t begin = 0; begin <= names.size();) {
        const std::size_t end = std::min(names.find(',', begin), names.size());
        const std::string name = names.substr(begin, end - begin);
        Method method{};
        set(Setting{"methods", "", "", ""}, name, fmt::format("--methods {}", names), ErrorCode::usage, method);
        const bool is_there = std::find(methods.begin(), methods.end(), method) != methods.end();
        if (method != Method::reference && !is_there) methods.push_back(method);
        begin = end + 1;
    }
    return methods;
}

std::string light_sentence(const Scene& scene) {
    const ProbeSettings& probe = scene.lighting.probe;
    const char* how =
        shows_surfaces(scene.illumination)
            ? "Pictures are as they are shown; methods that take no probe, and their reference, are under a "
              "white one."
            : "Every method lights particles that scatter it once, alike in all directions.";
    Lighting lighting = scene.lighting;
    if (!probe.source.empty()) lighting.loaded_probe = load_probe(lighting);
    return fmt::format("Light: probe {}, turned by {:g} degrees, {:+g} stops. {}",
                       probe.source.empty() ? "white" : std::filesystem::path(probe.source).filename().string(),
                       probe.rotation_deg, exposure_stops(lighting), how);
}

void write(const MethodComparison& comparison, const Scene& scene, const std::filesystem::path& page) {
    std::filesystem::path sheet = page;
    sheet.replace_extension(".png");
    const Metadata metadata{{"chiaro", to_json(seen_from(scene, page.parent_path()))}};
    write_png(sheet_of(comparison), sheet, metadata);
    const std::string name = std::filesystem::path(scene.volume).filename().string();
    write_text(page, page_of(comparison, "Lighting methods on " + name, light_sentence(scene)));
}

}  // namespace

void MethodsOptions::add_to(CLI::App& app) {
    app.add_option("--methods", names, "lighting methods to be compared on a volume with the reference, path traced")
        ->type_name("NAME,NAME...");
    app.add_option("--scene", scene, "scene file, instead of a VOLUME; flags beside it win")->type_name("FILE");
    app.add_option("--data", data, "folder where volumes of scenes are looked up after the scene's own")
        ->type_name("DIR");
    app.add_option("-o,--output", output, "page to write, .html, and beside it a contact sheet, .png")
        ->type_name("PAGE");
}

void compare_on_volume(const MethodsOptions& options, const Limits& limits, bool as_json, const SettingFlags& flags,
                       const CommonOptions& common) {
    const std::vector<Method> methods = methods_in(options.names);
    Scene scene = scene_from({options.volume, options.scene, options.data}, flags, common, "compare");
    if (!options.output.empty()) check_output(options.output, {".html"});
    (void)limits.broken(metrics_of({}));  // refuses what it does not understand, before long work
    const Device device = device_of(common);
    Session session(device);
    Stats stats;
    Job job(common);
    show(scene, session, stats, job, common);
    const MethodComparison comparison =
        stats.stage("compare", [&] { return compare_methods(session, scene, methods, job.progress); });
    job.bar.clear();

    std::vector<std::string> failures;
    for (const MethodImage& image : comparison.images)
        for (const std::string& failure : limits.broken(metrics_of(image.distance)))
            failures.push_back(fmt::format("{}'s {}", to_text(image.method), failure));
    if (!options.output.empty()) write(comparison, scene, options.output);
    fmt::print("{}", as_json ? json_of(comparison).dump(2) + "\n" : table_of(comparison));
    if (common.verbose) tell_stages(stats, device);
    if (!failures.empty())
        throw Error(ErrorCode::difference, fmt::format("{}: {}", scene.volume, fmt::join(failures, ", ")));
}

}  // namespace chiaro::cli
