#include "core/atomic_file.h"
#include "core/file_contents.h"
#include "image/exr.h"
#include "image/png.h"

namespace chiaro {
namespace {

void write(const std::filesystem::path& path, std::span<const std::byte> bytes, const Progress* progress) {
    constexpr std::size_t piece = 16 << 20;
    AtomicFile file(path);
    for (; !bytes.empty(); bytes = bytes.subspan(std::min(piece, bytes.size()))) {
        if (progress) progress->check();
        file.write(bytes.first(std::min(piece, bytes.size())));
    }
    file.commit();
}

}  // namespace

void write_png(const Image& image, const std::filesystem::path& path, const Metadata& metadata,
               const Progress* progress) {
    write(path, encode_png(image, metadata, progress), progress);
}

Image read_png(const std::filesystem::path& path) { return decode_png(file_bytes(path), path.string()).image; }

Metadata read_png_metadata(const std::filesystem::path& path) {
    return decode_png(file_bytes(path), path.string()).metadata;
}

void write_exr(const Frame& frame, const std::filesystem::path& path, const Metadata& metadata,
               const Progress* progress) {
    write(path, encode_exr(frame, metadata, progress), progress);
}

Frame read_exr(const std::filesystem::path& path) { return decode_exr(file_bytes(path), path.string()).frame; }

Metadata read_exr_metadata(const std::filesystem::path& path) {
    return decode_exr_metadata(file_bytes(path), path.string());
}

}  // namespace chiaro
