#include "render/scene_files.h"

#include <chiaro/error.h>
#include <chiaro/image.h>
#include <chiaro/scene.h>
#include <chiaro/transfer_file.h>
#include <fmt/format.h>

#include "core/file_contents.h"
#include "core/text.h"
#include "io/wire.h"

namespace chiaro {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t max_scene_bytes = 64u << 20;

bool names_no_file(const std::string& name) {
    return name.empty() || name == "-" || name.starts_with("sample:") || wire::is_url(name);
}

std::string text_in(const Metadata& metadata, const fs::path& file) {
    for (const auto& [key, text] : metadata)
        if (key == "chiaro") return text;
    throw Error(ErrorCode::input, fmt::format("{}: this picture carries no scene", file.string()));
}

std::string text_of(const fs::path& file) {
    if (file.extension() == ".png") return text_in(read_png_metadata(file), file);
    if (file.extension() == ".exr") return text_in(read_exr_metadata(file), file);
    return file_text(file, max_scene_bytes);
}

}  // namespace

bool is_file(const fs::path& path) {
    std::error_code no_access;
    return fs::exists(path, no_access);
}

std::string found_file(const std::string& name, const fs::path& folder, const fs::path& data_folder) {
    if (names_no_file(name)) return name;
    const std::string file = name.substr(0, name.find(":/"));
    const auto is_there = [&](const fs::path& where) {
        return is_file(where / file) || !moment_files((where / file).string()).empty();
    };
    const bool only_in_data = !is_there(folder) && !data_folder.empty() && is_there(data_folder);
    return ((only_in_data ? data_folder : folder) / name).lexically_normal().string();
}

std::string found_function(const std::string& name, const fs::path& folder, const fs::path& data_folder) {
    const auto [file, function] = split_transfer_name(name);
    return found_file(file, folder, data_folder) + (function.empty() ? "" : "#" + function);
}

Scene seen_from(Scene scene, const fs::path& folder) {
    const auto see = [base = fs::absolute(folder / ".").lexically_normal()](const std::string& name) {
        return fs::absolute(name).lexically_normal().lexically_proximate(base).string();
    };
    if (!names_no_file(scene.volume)) scene.volume = see(scene.volume);
    const auto see_function = [&](std::string& source) {
        if (const auto [file, function] = split_transfer_name(source); is_file(file))
            source = see(file) + (function.empty() ? "" : "#" + function);
    };
    see_function(scene.transfer.source);
    for (ChannelSettings& channel : scene.channels) {
        if (!names_no_file(channel.file)) channel.file = see(channel.file);
        see_function(channel.transfer.source);
    }
    if (!scene.labels.loaded && !names_no_file(scene.labels.source)) scene.labels.source = see(scene.labels.source);
    if (is_file(scene.labels.table)) scene.labels.table = see(scene.labels.table);
    if (std::string& probe = scene.lighting.probe.source; !is_probe_name(probe)) probe = see(probe);
    HistogramSettings& histogram = scene.illumination.histogram;
    if (is_file(histogram.emission)) histogram.emission = see(histogram.emission);
    if (histogram.cache != "none") histogram.cache.clear();  // where this machine keeps things is nobody else's
    return scene;
}

Scene read_scene(const fs::path& file, const fs::path& data_folder, std::vector<std::string>& notes) {
    if (file.extension() == ".pvsm") return read_paraview_state(file, data_folder, notes);
    const std::string text = text_of(file);
    try {
        std::vector<std::string> unknown_keys;
        Scene scene = parse_scene(text, file.parent_path(), data_folder, unknown_keys);
        notes.clear();
        for (const std::string& key : unknown_keys) notes.push_back("unknown key " + key);
        return scene;
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}", file.string(), one_line(error.what(), 1000)));
    }
}

}  // namespace chiaro
