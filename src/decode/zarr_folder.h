// The folder of a Zarr store, out of which nothing leads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace chiaro::decode {

/// An open descriptor.
class OpenFile {
public:
    explicit OpenFile(int number) : number_(number) {}
    OpenFile(OpenFile&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    OpenFile& operator=(OpenFile&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~OpenFile();
    int number() const { return number_; }
    std::uint64_t size() const;
    /// Throws Error{input} where fewer bytes are there.
    void read(std::uint64_t offset, std::span<std::byte> to) const;

private:
    int number_;
};

/// Paths are relative, with '/' between names. No link below the folder itself is followed.
class ZarrFolder {
public:
    explicit ZarrFolder(const std::filesystem::path& path);
    /// A regular file; none where there is nothing of that name. Throws Error{input} for links and all other kinds.
    std::optional<OpenFile> open(const std::string& path) const;
    /// The same as JSON. Throws Error{input} for what is none, or is nested deeply, or states a member twice.
    std::optional<nlohmann::json> json(const std::string& path) const;
    /// Names in a folder, in order; empty where there is none.
    std::vector<std::string> names(const std::string& path) const;

private:
    std::optional<OpenFile> open_last(const std::string& path, int flags) const;

    OpenFile root_;
};

/// "a/b" of "a" and "b", either of which may be empty. Throws Error{input} for names that lead out.
std::string joined(const std::string& folder, const std::string& name);

}  // namespace chiaro::decode
