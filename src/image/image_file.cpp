#include "core/atomic_file.h"
#include "core/file_contents.h"
#include "image/exr.h"
#include "image/png.h"

namespace chiaro {
namespace {

void write(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace

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
