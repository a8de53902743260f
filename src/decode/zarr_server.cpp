// Stores on a server: chiaro-fetch fetches, this program decodes and opens no connection.
#include "decode/zarr_store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <span>
#include <utility>

namespace chiaro::decode {
namespace {

/// Bytes from the program that fetches.
class FetchConnection {
public:
    explicit FetchConnection(Output& output) : output_(output) {}

    void ask(const std::string& line) {
        for (std::size_t sent = 0; sent < line.size();) {
            const ssize_t n = write(wire::fetch_descriptor, line.data() + sent, line.size() - sent);
            if (n <= 0) refuse(is_gone);
            sent += std::size_t(n);
        }
    }
    std::string line() {
        constexpr std::size_t longest = 4096;
        for (;;) {
            if (const auto end = received_.find('\n'); end != std::string::npos) {
                std::string line = received_.substr(0, end);
                received_.erase(0, end + 1);
                return line;
            }
            char piece[longest];
            if (received_.size() > longest) refuse(is_gone);
            received_.append(piece, receive(piece, sizeof piece));
        }
    }
    void take(std::span<std::byte> to) {
        const std::size_t there = std::min(received_.size(), to.size());
        std::memcpy(to.data(), received_.data(), there);
        received_.erase(0, there);
        for (std::size_t done = there; done < to.size();) done += receive(to.data() + done, to.size() - done);
    }

private:
    static constexpr const char* is_gone = "the program that fetches it has ended, or makes no sense";

    std::size_t receive(void* to, std::size_t most) {
        const ssize_t n = ::read(wire::fetch_descriptor, to, most);
        if (n <= 0) refuse(is_gone);
        output_.go_on();
        return std::size_t(n);
    }

    Output& output_;
    std::string received_;
};

class ZarrOnServer final : public ZarrStore {
public:
    explicit ZarrOnServer(Output& output) : connection_(output) {}

    std::optional<std::uint64_t> read(const std::string& path, FilePart part,
                                      std::vector<std::byte>& to) const override {
        using enum FilePart::Kind;
        check(path);
        connection_.ask(part.kind == range  ? fmt::format("range {} {} {}\n", part.first, part.bytes, path)
                        : part.kind == last ? fmt::format("last {} {}\n", part.bytes, path)
                                            : fmt::format("all {} {}\n", part.bytes, path));
        std::string line;
        while ((line = connection_.line()) == "wait") continue;
        if (line.starts_with("fault ")) refuse(line.substr(6));
        if (line.starts_with("none ")) {
            if (line == "none 403" && part.kind == all && is_metadata(path)) return {};
            if (line == "none 403") refuse(fmt::format("has a '{}' that its server forbids to read (403)", path));
            return {};
        }
        std::uint64_t bytes = 0, size = 0;
        const char *at = line.data() + std::string_view("part ").size(), *end = line.data() + line.size();
        const auto first = std::from_chars(std::min(at, end), end, bytes);
        if (!line.starts_with("part ") || first.ec != std::errc() || first.ptr == end ||
            std::from_chars(first.ptr + 1, end, size).ec != std::errc() || bytes > part.bytes)
            refuse("the program that fetches it makes no sense");
        to.resize(bytes);
        connection_.take(to);
        return size;
    }

    /// A server tells no names; those that metadata state: of labels, of a plate's first wells and their fields, and of
    /// a file's images.
    std::vector<std::string> names(const std::string& path) const override {
        nlohmann::json attributes;
        if (auto node = json(joined(path, "zarr.json")))
            attributes = node->value("attributes", nlohmann::json::object());
        else if (auto older = json(joined(path, ".zattrs")))
            attributes = *older;
        if (attributes.is_object() && attributes.contains("ome")) attributes = attributes.at("ome");
        std::vector<std::string> names;
        if (!attributes.is_object()) return names;
        for (const auto& name : attributes.value("labels", nlohmann::json::array()))
            if (name.is_string()) names.push_back(name.get<std::string>());
        for (const auto& [owner, list] : {std::pair("plate", "wells"), std::pair("well", "images")})
            if (attributes.contains(owner))
                for (const auto& one : attributes.at(owner).value(list, nlohmann::json::array()))
                    if (names.size() < max_wells) names.push_back(one.at("path").get<std::string>());
        if (names.empty() && attributes.contains("bioformats2raw.layout"))
            for (int i = 0; i < max_images; ++i) {
                const std::string name = std::to_string(i), image = joined(path, name);
                if (!json(image + "/zarr.json") && !json(image + "/.zattrs")) break;
                names.push_back(name);
            }
        return names;
    }
    bool lists_names() const override { return false; }

private:
    static constexpr std::size_t max_wells = 4;  // which are looked at one after the other
    static constexpr int max_images = 100;

    static bool is_metadata(const std::string& path) {
        const std::string name = path.substr(path.rfind('/') + 1);
        return name == "zarr.json" || name == ".zarray" || name == ".zattrs" || name == ".zgroup";
    }

    mutable FetchConnection connection_;
};

}  // namespace

std::unique_ptr<ZarrStore> open_zarr_on_server(Output& output) { return std::make_unique<ZarrOnServer>(output); }

}  // namespace chiaro::decode
