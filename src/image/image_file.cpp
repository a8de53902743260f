#include <chiaro/error.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/atomic_file.h"
#include "core/did_you_mean.h"
#include "image/exr.h"
#include "image/file_bytes.h"
#include "image/png.h"

namespace chiaro {
namespace {

constexpr std::uintmax_t max_file_bytes = 2048u << 20;

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace

std::vector<std::byte> file_bytes(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& what) {
        return Error(ErrorCode::input, "cannot read '" + path.string() + "': " + what);
    };
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);  // fails for what is no regular file
    if (error == std::errc::no_such_file_or_directory) throw fail(error.message() + did_you_mean_file(path));
    if (error) throw fail(error.message());
    if (size > max_file_bytes) throw fail("is larger than 2 GiB");
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> bytes(size);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
        throw fail(std::generic_category().message(errno ? errno : EIO));
    return bytes;
}

void write_png(const Image& image, const std::filesystem::path& path, const Metadata& metadata) {
    write(path, encode_png(image, metadata));
}

Image read_png(const std::filesystem::path& path) { return decode_png(file_bytes(path), path.string()).image; }

Metadata read_png_metadata(const std::filesystem::path& path) {
    return decode_png(file_bytes(path), path.string()).metadata;
}

void write_exr(const Frame& frame, const std::filesystem::path& path, const Metadata& metadata) {
    write(path, encode_exr(frame, metadata));
}

Frame read_exr(const std::filesystem::path& path) { return decode_exr(file_bytes(path), path.string()).frame; }

Metadata read_exr_metadata(const std::filesystem::path& path) {
    return decode_exr_metadata(file_bytes(path), path.string());
}

}  // namespace chiaro
