#include "limits.h"

#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <cmath>

#include "core/did_you_mean.h"

namespace chiaro::cli {
namespace {

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

}  // namespace

Metrics metrics_of(const ImageDifference& d) {
    return {{"rmse", d.rmse},
            {"psnr", d.psnr, Kind::likeness},
            {"ssim", d.ssim, Kind::likeness},
            {"max", d.max},
            {"bias", d.bias}};
}

void Limits::add_to(CLI::App& app) {
    app.add_option("--fail-above", above, "exit code 5 where rmse, max or the size of bias is more; repeatable")
        ->type_name("METRIC=V")
        ->allow_extra_args(false);
    app.add_option("--fail-below", below, "exit code 5 where psnr, ssim or correlation is less; repeatable")
        ->type_name("METRIC=V")
        ->allow_extra_args(false);
}

std::vector<std::string> Limits::broken(const Metrics& metrics) const {
    std::vector<std::string> failures;
    const auto check = [&](const std::vector<std::string>& limits, Kind kind) {
        for (const auto& limit : limits)
            if (const std::string failure = cli::broken(limit, kind, metrics); !failure.empty())
                failures.push_back(failure);
    };
    check(above, Kind::distance);
    check(below, Kind::likeness);
    return failures;
}

}  // namespace chiaro::cli
