// chiaro compare: how far apart two pictures are, or two fields.
#include <chiaro/compare.h>
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "command.h"
#include "core/did_you_mean.h"
#include "job.h"
#include "volume_json.h"

namespace chiaro::cli {
namespace {

struct CompareOptions {
    std::string a, b;
    std::vector<std::string> fail_above, fail_below;
    bool json = false;
    CommonOptions common;
};

enum class Kind { distance, likeness };

struct Metric {
    std::string name;
    double value;
    Kind kind = Kind::distance;
};
using Metrics = std::vector<Metric>;

bool is_png(const std::string& name) { return std::filesystem::path(name).extension() == ".png"; }
bool is_exr(const std::string& name) { return std::filesystem::path(name).extension() == ".exr"; }
bool is_picture(const std::string& name) { return is_png(name) || is_exr(name); }

Frame read_picture(const std::string& name) { return is_png(name) ? display_values(read_png(name)) : read_exr(name); }

Metrics compare_pictures(const std::string& a, const std::string& b) {
    if (is_png(a) != is_png(b))
        throw Error(ErrorCode::usage,
                    fmt::format("{} and {}: display values and linear light cannot be compared", a, b));
    const ImageDifference d = compare(read_picture(a), read_picture(b));
    return {{"rmse", d.rmse},
            {"psnr", d.psnr, Kind::likeness},
            {"ssim", d.ssim, Kind::likeness},
            {"max", d.max},
            {"bias", d.bias}};
}

Metrics compare_fields(const CompareOptions& o) {
    Job job(o.common);
    const Volume a = read_volume(o.a, {}, job.progress), b = read_volume(o.b, {}, job.progress);
    const FieldDifference d = compare(a, b);
    return {{"rmse", d.rmse}, {"max", d.max}, {"bias", d.bias}, {"correlation", d.correlation, Kind::likeness}};
}

Metrics compare_files(const CompareOptions& o) {
    if (o.a.empty() || o.b.empty()) throw Error(ErrorCode::usage, "A or B is missing; see chiaro compare --help");
    if (is_picture(o.a) != is_picture(o.b))
        throw Error(ErrorCode::usage, fmt::format("{} and {}: a picture and a field cannot be compared", o.a, o.b));
    return is_picture(o.a) ? compare_pictures(o.a, o.b) : compare_fields(o);
}

const Metric& metric_named(const std::string& name, const Metrics& metrics, const std::string& who) {
    std::vector<std::string> names;
    for (const Metric& metric : metrics) {
        if (metric.name == name) return metric;
        names.push_back(metric.name);
    }
    throw Error(ErrorCode::usage,
                fmt::format("{}: must be one of {}{}", who, fmt::join(names, ", "), did_you_mean(name, names)));
}

/// What is said of a limit METRIC=V that does not hold, else "". What cannot be computed holds no limit.
std::string broken(const std::string& limit, Kind kind, const Metrics& metrics) {
    const char* flag = kind == Kind::distance ? "--fail-above" : "--fail-below";
    const std::string who = fmt::format("{} {}", flag, limit);
    const std::size_t equals = std::min(limit.find('='), limit.size());
    const auto bound = numbers_in(limit.substr(std::min(equals + 1, limit.size())));
    if (bound.size() != 1) throw Error(ErrorCode::usage, fmt::format("{}: expected METRIC=V", who));
    const Metric& metric = metric_named(limit.substr(0, equals), metrics, who);
    if (metric.kind != kind)
        throw Error(ErrorCode::usage, fmt::format("{}: for {} {} is better; use {}", who, metric.name,
                                                  kind == Kind::distance ? "more" : "less",
                                                  kind == Kind::distance ? "--fail-below" : "--fail-above"));
    const bool holds = kind == Kind::distance ? std::abs(metric.value) <= bound[0] : metric.value >= bound[0];
    return holds ? ""
                 : fmt::format("{} {:.6g} is {} {:.6g}", metric.name, metric.value,
                               kind == Kind::distance ? "above" : "below", bound[0]);
}

void print(const Metrics& metrics, bool as_json) {
    Json json;
    for (const auto& [name, value, kind] : metrics) {
        json[name] = value;  // JSON knows no infinity: it becomes null
        if (!as_json) fmt::print("{:<12}{:.6g}\n", name, value);
    }
    if (as_json) fmt::print("{}\n", json.dump(2));
}

void run(const CompareOptions& o) {
    const Metrics metrics = compare_files(o);
    std::vector<std::string> failures;
    const auto check = [&](const std::vector<std::string>& limits, Kind kind) {
        for (const auto& limit : limits)
            if (const std::string failure = broken(limit, kind, metrics); !failure.empty()) failures.push_back(failure);
    };
    check(o.fail_above, Kind::distance);
    check(o.fail_below, Kind::likeness);
    print(metrics, o.json);
    if (!failures.empty())
        throw Error(ErrorCode::difference, fmt::format("{} and {}: {}", o.a, o.b, fmt::join(failures, ", ")));
}

}  // namespace

Command compare_command(CLI::App& tool) {
    const auto o = std::make_shared<CompareOptions>();
    CLI::App* app = tool.add_subcommand("compare", "Tells how far apart two pictures are, or two fields");
    app->add_option("A", o->a, "picture (.png, .exr), or volume or field, as for info");
    app->add_option("B", o->b, "what is compared with it, of the same size");
    app->add_option("--fail-above", o->fail_above,
                    "exit code 5 where rmse, max or the size of bias is more; repeatable")
        ->type_name("METRIC=V")
        ->allow_extra_args(false);
    app->add_option("--fail-below", o->fail_below, "exit code 5 where psnr, ssim or correlation is less; repeatable")
        ->type_name("METRIC=V")
        ->allow_extra_args(false);
    app->add_flag("--json", o->json, "as JSON; null for the psnr of equal pictures, and for what cannot be computed");
    add_common_options(*app, o->common);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
