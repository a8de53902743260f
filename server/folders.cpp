#include "folders.h"

#include <chiaro/io.h>
#include <fmt/format.h>

#include <algorithm>

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t max_entries = 2000;

bool is_below(const fs::path& path, const fs::path& root) {
    const auto [end, ignored] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
    return end == root.end();
}

[[noreturn]] void refuse_path(const std::string& path) {
    throw Error(ErrorCode::input, fmt::format("{}: lies outside the folders that the viewer was started with", path));
}

/// By its ending; whether it can be read is found out when it is opened.
const char* kind_of(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    const auto is_among = [&](std::initializer_list<std::string_view> endings) {
        return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    if (is_among({".json", ".png"})) return "scene";
    if (is_among({".vp", ".itf", ".tfi"})) return "transfer";
    if (is_among({".hdr", ".exr"})) return "probe";
    if (is_among({".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".gz", ".dcm", ".tif", ".tiff", ".vtk", ".vti", ".pvti",
                  ".pvd", ".vtkhdf", ".h5", ".hdf5", ".vdb", ".raw"}))
        return "volume";
    return nullptr;
}

Json entry_of(const fs::directory_entry& entry) {
    std::error_code error;
    const std::string name = entry.path().filename().string();
    if (name.starts_with(".")) return {};
    if (entry.is_directory(error) && name.ends_with(".zarr"))
        return {{"name", name}, {"path", entry.path().string()}, {"kind", "volume"}, {"bytes", 0}};
    if (entry.is_directory(error))
        return {{"name", name}, {"path", entry.path().string()}, {"kind", "folder"}, {"bytes", 0}};
    const char* kind = entry.is_regular_file(error) ? kind_of(entry.path()) : nullptr;
    if (!kind) return {};
    const auto bytes = entry.file_size(error);
    return {{"name", name}, {"path", entry.path().string()}, {"kind", kind}, {"bytes", error ? 0 : bytes}};
}

}  // namespace

Folders::Folders(const std::vector<fs::path>& roots, const std::vector<fs::path>& hidden) {
    for (const fs::path& folder : hidden) hidden_.push_back(fs::weakly_canonical(folder));
    for (const fs::path& root : roots) {
        const fs::path whole = fs::weakly_canonical(fs::absolute(root));
        if (std::find(roots_.begin(), roots_.end(), whole) == roots_.end()) roots_.push_back(whole);
    }
}

fs::path Folders::allowed(const std::string& path) const {
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(roots_.front() / path, error);
    const auto holds = [&](const fs::path& root) { return is_below(whole, root); };
    const bool is_held =
        std::any_of(roots_.begin(), roots_.end(), holds) || std::any_of(hidden_.begin(), hidden_.end(), holds);
    if (error || path.find('\0') != path.npos || !is_held) refuse_path(path);
    return whole;
}

std::string Folders::allowed_volume(const std::string& name) const {
    if (name.starts_with("sample:")) return name;
    if (name.empty() || name == "-") throw Error(ErrorCode::input, fmt::format("'{}': names no volume", name));
    const auto [file, part] = split_volume_name((roots_.front() / name).string());
    const std::string whole = allowed(file).string(), found = part.empty() ? whole : whole + ":" + part;
    // What is read is what was looked at: ":/" may stand in a folder's name, too.
    if (split_volume_name(found).first != whole) refuse_path(name);
    return found;
}

void Folders::confine(Scene& scene) const {
    const auto confined = [&](std::string& file) { file = allowed(file).string(); };
    // A name without '/' and '.' is a preset's or a probe's, as load_probe and load_transfer_function have it; a file
    // of such a name in the program's own folder is not meant.
    const auto confined_name = [&](std::string& name) {
        if (name.find_first_of("/.") != name.npos) confined(name);
    };
    confined_name(scene.transfer.source);
    confined_name(scene.labels.table);
    std::string& labels = scene.labels.source;  // a volume that is its own labels is told by its name
    if (!labels.empty() && labels != scene.volume) labels = allowed_volume(labels);
    for (ChannelSettings& channel : scene.channels) {
        if (!channel.file.empty()) channel.file = allowed_volume(channel.file);
        confined_name(channel.transfer.source);
    }
    if (!is_probe_name(scene.lighting.probe.source) && !scene.lighting.probe.source.empty())
        confined(scene.lighting.probe.source);
    HistogramSettings& histogram = scene.illumination.histogram;
    if (!histogram.emission.empty() && histogram.emission.find('=') == histogram.emission.npos)
        confined(histogram.emission);
    if (histogram.cache != "none") histogram.cache.clear();
}

Json Folders::list(const std::string& path) const {
    Json folders = Json::array(), files = Json::array();
    if (path.empty()) {
        for (const fs::path& root : roots_)
            folders.push_back({{"name", root.string()}, {"path", root.string()}, {"kind", "folder"}, {"bytes", 0}});
        return {{"path", ""}, {"parent", nullptr}, {"entries", std::move(folders)}};
    }
    const fs::path folder = allowed(path);
    std::error_code error;
    fs::directory_iterator entries(folder, error);
    if (error) throw Error(ErrorCode::input, fmt::format("{}: cannot be read ({})", path, error.message()));
    for (; entries != fs::directory_iterator() && !error && folders.size() + files.size() < max_entries;
         entries.increment(error)) {
        Json entry = entry_of(*entries);
        if (!entry.is_null()) (entry["kind"] == "folder" ? folders : files).push_back(std::move(entry));
    }
    const auto by_name = [](const Json& a, const Json& b) { return a["name"] < b["name"]; };
    std::sort(folders.begin(), folders.end(), by_name);
    std::sort(files.begin(), files.end(), by_name);
    folders.insert(folders.end(), files.begin(), files.end());
    const bool is_root = std::find(roots_.begin(), roots_.end(), folder) != roots_.end();
    return {{"path", folder.string()},
            {"parent", is_root ? "" : folder.parent_path().string()},
            {"entries", std::move(folders)}};
}

}  // namespace chiaro::server
