#include <chiaro/error.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/atomic_file.h"
#include "image/png.h"

namespace chiaro {
namespace {

constexpr std::uintmax_t max_file_bytes = 512u << 20;

DecodedPng read(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& what) {
        return Error(ErrorCode::input, "cannot read '" + path.string() + "': " + what);
    };
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);  // fails for what is no regular file
    if (error) throw fail(error.message());
    if (size > max_file_bytes) throw fail("is larger than 512 MiB");
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> bytes(size);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
        throw fail(std::generic_category().message(errno ? errno : EIO));
    return decode_png(bytes, path.string());
}

}  // namespace

void write_png(const Image& image, const std::filesystem::path& path, const Metadata& metadata) {
    const std::vector<std::byte> bytes = encode_png(image, metadata);
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

Image read_png(const std::filesystem::path& path) { return read(path).image; }

Metadata read_png_metadata(const std::filesystem::path& path) { return read(path).metadata; }

}  // namespace chiaro
