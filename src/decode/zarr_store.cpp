#include "decode/zarr_store.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace chiaro::decode {

std::optional<nlohmann::json> ZarrStore::json(const std::string& path) const {
    constexpr std::uint64_t most = 16 << 20;
    std::vector<std::byte> bytes;
    if (!read(path, FilePart::all(most), bytes)) return {};
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (is_deeper_than(64, text)) refuse(fmt::format("has a '{}' that is nested too deeply", path));
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object()) refuse(fmt::format("has a '{}' that is no JSON object", path));
    if (const std::string twice = json_contradiction(text); !twice.empty())
        refuse(fmt::format("has a '{}' that {}", path, twice));
    return json;
}

void ZarrStore::check(const std::string& path) {
    for (std::size_t begin = 0, end = 0; end != path.npos; begin = end + 1) {
        end = path.find('/', begin);
        const std::string_view name = std::string_view(path).substr(begin, end - begin);
        if (name.empty() || name == "..") refuse(fmt::format("names '{}', which leads out of its folder", path));
    }
    if (std::ranges::any_of(path, [](unsigned char c) { return c < 32 || c == 127; }))
        refuse(fmt::format("names '{}', which is no name of a file", path));
}

std::string joined(const std::string& folder, const std::string& name) {
    if (folder.empty() || name.empty()) return folder + name;
    return folder + "/" + name;
}

}  // namespace chiaro::decode
