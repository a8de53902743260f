// Where a Zarr store lies: in a folder, or on a server.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "decode/output.h"

namespace chiaro::decode {

/// What of a file is read.
struct FilePart {
    enum class Kind { all, range, last };
    Kind kind = Kind::all;
    std::uint64_t first = 0, bytes = 0;  ///< of `all`: no more than so many

    static FilePart all(std::uint64_t most) { return {Kind::all, 0, most}; }
    static FilePart range(std::uint64_t first, std::uint64_t bytes) { return {Kind::range, first, bytes}; }
    static FilePart last(std::uint64_t bytes) { return {Kind::last, 0, bytes}; }
};

/// Paths are relative, with '/' between names, and lead nowhere else.
class ZarrStore {
public:
    virtual ~ZarrStore() = default;
    /// Fills `to` with a part of a file and returns the whole file's size; none where there is no file of that name.
    /// Throws Error{input} where fewer bytes are there, or more than `all` may be, and for what is no regular file.
    virtual std::optional<std::uint64_t> read(const std::string& path, FilePart part,
                                              std::vector<std::byte>& to) const = 0;
    /// Names in a folder, in order, as far as they can be known; empty where there is none.
    virtual std::vector<std::string> names(const std::string& path) const = 0;
    /// Whether `names` knows them all.
    virtual bool lists_names() const = 0;

    /// A file as JSON. Throws Error{input} for what is none, or is nested deeply, or states a member twice.
    std::optional<nlohmann::json> json(const std::string& path) const;

protected:
    /// Throws Error{input} for a path that leads out, or is none.
    static void check(const std::string& path);
};

/// A folder below which no link is followed.
std::unique_ptr<ZarrStore> open_zarr_folder(const std::string& path);
/// What chiaro-fetch fetches, over the connection that this program was started with. Tells `output` that it goes on.
std::unique_ptr<ZarrStore> open_zarr_on_server(Output& output);

/// "a/b" of "a" and "b", either of which may be empty.
std::string joined(const std::string& folder, const std::string& name);

}  // namespace chiaro::decode
