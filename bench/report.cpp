#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "cuda/stream.h"

namespace chiaro::bench {
namespace {

std::string cpu() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown";
}

std::string gpu(const Setup& setup) { return setup.device.has_gpu() ? ", " + setup.device.stream->gpu().name : ""; }

nlohmann::ordered_json json_of(const Row& row) {
    nlohmann::ordered_json json{{"name", row.name},     {"value", nullptr},    {"unit", row.unit},
                                {"ratio", nullptr},     {"to", row.to},        {"runs", row.value.runs},
                                {"min", row.value.min}, {"max", row.value.max}};
    if (row.value.runs > 0) json["value"] = row.value.median;
    if (row.ratio) json["ratio"] = *row.ratio;
    if (!row.note.empty()) json["note"] = row.note;
    for (const auto& figure : row.beside.papers) json["papers"].push_back({{"value", figure.value}, {"of", figure.of}});
    if (row.beside.target) json["target"] = *row.beside.target;
    return json;
}

}  // namespace

std::string heading(const Setup& setup) {
    return fmt::format("{}, {}, {} threads{}, chiaro {} {}\n{:<44} {:>10} {:>10} {:>10}  {}", cpu(),
                       name_of(setup.device.isa), setup.device.threads, gpu(setup), CHIARO_VERSION, CHIARO_COMMIT,
                       "row", "median", "min", "max", "unit");
}

std::string line_of(const Row& row) {
    if (row.value.runs == 0) return fmt::format("{:<44} {}", row.name, row.note);
    std::string line = fmt::format("{:<44} {:>10.4g} {:>10.4g} {:>10.4g}  {}", row.name, row.value.median,
                                   row.value.min, row.value.max, row.unit);
    if (row.ratio) line += fmt::format("; {:.3g} x {}", *row.ratio, row.to);
    if (!row.note.empty()) line += "; " + row.note;
    for (const auto& figure : row.beside.papers) line += fmt::format("; paper {:.4g}, {}", figure.value, figure.of);
    if (row.beside.target) line += fmt::format("; target {:.3g}", *row.beside.target);
    return line;
}

std::string to_json(const Setup& setup, const std::vector<Row>& rows) {
    nlohmann::ordered_json json{
        {"chiaro", CHIARO_VERSION},      {"commit", CHIARO_COMMIT},          {"machine", cpu() + gpu(setup)},
        {"device", setup.device.name()}, {"isa", name_of(setup.device.isa)}, {"threads", setup.device.threads},
        {"quick", setup.quick}};
    json["rows"] = nlohmann::json::array();
    for (const Row& row : rows) json["rows"].push_back(json_of(row));
    return json.dump(2) + "\n";
}

}  // namespace chiaro::bench
