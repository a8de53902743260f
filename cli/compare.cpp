// chiaro compare: how far apart two pictures are, or two fields; or lighting methods, from the ground truth.
#include <chiaro/compare.h>
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "compare_methods.h"
#include "limits.h"

namespace chiaro::cli {
namespace {

struct CompareOptions {
    std::string a, b;
    MethodsOptions methods;
    Limits limits;
    bool json = false;
    SettingFlags flags;
    CommonOptions common;
};

bool is_png(const std::string& name) { return std::filesystem::path(name).extension() == ".png"; }
bool is_exr(const std::string& name) { return std::filesystem::path(name).extension() == ".exr"; }
bool is_image(const std::string& name) { return is_png(name) || is_exr(name); }

Frame read_image(const std::string& name) { return is_png(name) ? display_values(read_png(name)) : read_exr(name); }

Metrics compare_images(const std::string& a, const std::string& b, Stats& stats) {
    if (is_png(a) != is_png(b))
        throw Error(ErrorCode::usage,
                    fmt::format("{} and {}: display values and linear light cannot be compared", a, b));
    const auto [first, second] = stats.stage("read", [&] { return std::pair(read_image(a), read_image(b)); });
    return stats.stage("compare", [&, &x = first, &y = second] { return metrics_of(compare(x, y)); });
}

Metrics compare_fields(const CompareOptions& o, Stats& stats) {
    Job job(o.common);
    const auto read = [&](const std::string& name) { return read_volume(name, {}, job.progress); };
    const Volume a = stats.stage("read", [&] { return read(o.a); }), b = stats.stage("read", [&] { return read(o.b); });
    const FieldDifference d = stats.stage("compare", [&] { return compare(a, b); });
    return {{"rmse", d.rmse}, {"max", d.max}, {"bias", d.bias}, {"correlation", d.correlation, Kind::likeness}};
}

void print(const Metrics& metrics, bool as_json) {
    Json json;
    for (const auto& [name, value, kind] : metrics) {
        json[name] = value;  // JSON knows no infinity: it becomes null
        if (!as_json) fmt::print("{:<12}{:.6g}\n", name, value);
    }
    if (as_json) fmt::print("{}\n", json.dump(2));
}

void compare_files(const CompareOptions& o) {
    if (o.a.empty() || o.b.empty()) throw Error(ErrorCode::usage, "A or B is missing; see chiaro compare --help");
    if (!o.methods.scene.empty() || !o.methods.output.empty() || o.flags.any())
        throw Error(ErrorCode::usage,
                    "two files are compared as they are: only --methods takes a scene, -o or settings");
    if (is_image(o.a) != is_image(o.b))
        throw Error(ErrorCode::usage, fmt::format("{} and {}: a picture and a field cannot be compared", o.a, o.b));
    Stats stats;
    const Metrics metrics = is_image(o.a) ? compare_images(o.a, o.b, stats) : compare_fields(o, stats);
    const auto failures = o.limits.broken(metrics);
    print(metrics, o.json);
    if (o.common.verbose) tell_stages(stats);
    if (!failures.empty())
        throw Error(ErrorCode::difference, fmt::format("{} and {}: {}", o.a, o.b, fmt::join(failures, ", ")));
}

void run(const CompareOptions& o) {
    if (o.methods.names.empty()) return compare_files(o);
    if (!o.b.empty()) throw Error(ErrorCode::usage, fmt::format("--methods compares on one volume: what is {}?", o.b));
    MethodsOptions methods = o.methods;
    methods.volume = o.a;
    compare_on_volume(methods, o.limits, o.json, o.flags, o.common);
}

}  // namespace

Command compare_command(CLI::App& tool) {
    const auto o = std::make_shared<CompareOptions>();
    CLI::App* app = tool.add_subcommand(
        "compare", "Tells how far apart two pictures are, or two fields, or lighting methods from the ground truth");
    app->add_option("A", o->a, "picture (.png, .exr), volume or field, as for info; with --methods the volume");
    app->add_option("B", o->b, "what is compared with it, of the same size");
    o->methods.add_to(*app);
    o->limits.add_to(*app);
    app->add_flag("--json", o->json, "as JSON; null for the psnr of equal pictures, and for what cannot be computed");
    add_common_options(*app, o->common);
    o->flags.add_to(*app);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
