#include "core/atomic_file.h"

#include <chiaro/error.h>
#include <chiaro/io.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace chiaro {
namespace {

using Bytes = std::span<const std::byte>;

std::string text_of(const Vec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); }

/// Least and greatest stored value of an integer volume.
std::pair<double, double> stored_range(const Volume& volume) {
    return with_voxel_type(volume.type, [&](auto zero) {
        const auto values = volume.as<decltype(zero)>();
        const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
        return std::pair{double(*least), double(*greatest)};
    });
}

/// The type that holds slope * stored + intercept: the stored one where there is nothing to apply, 16 bits where the
/// result is whole and fits, else float.
VoxelType written_type(const Volume& volume) {
    if (volume.slope == 1 && volume.intercept == 0) return volume.type;
    const bool small = size_of(volume.type) <= 2,
               whole = std::trunc(volume.slope) == volume.slope && std::trunc(volume.intercept) == volume.intercept;
    if (!small || !whole) return VoxelType::f32;
    const auto [least, greatest] = stored_range(volume);
    const auto [low, high] =
        std::minmax({volume.slope * least + volume.intercept, volume.slope * greatest + volume.intercept});
    if (low >= 0 && high <= 65535) return VoxelType::u16;
    return low >= -32768 && high <= 32767 ? VoxelType::i16 : VoxelType::f32;
}

std::string geometry_fields(const Volume& volume) {
    const Geometry& g = volume.geometry;
    const bool list = volume.components > 1;
    const Geometry plain{g.spacing_mm, {}, Geometry{}.direction, World::unknown};
    if (g == plain)
        return fmt::format("spacings: {}{} {} {}\n", list ? "nan " : "", g.spacing_mm.x, g.spacing_mm.y,
                           g.spacing_mm.z);
    const auto step = [&](int axis) { return text_of(g.spacing_mm[axis] * g.direction[std::size_t(axis)]); };
    const char* space = g.world == World::lps   ? "space: left-posterior-superior"
                        : g.world == World::ras ? "space: right-anterior-superior"
                                                : "space dimension: 3";
    return fmt::format("{}\nspace directions: {}{} {} {}\nspace origin: {}\n", space, list ? "none " : "", step(0),
                       step(1), step(2), text_of(g.origin_mm));
}

/// Keys and values on one line each, as the format escapes them; a key cannot hold a colon.
std::string escaped(const std::string& text, bool key) {
    std::string result;
    for (char c : text) {
        if (c == '\\')
            result += "\\\\";
        else if (c == '\n')
            result += "\\n";
        else if (c == '\r' || (key && c == ':'))
            result += ' ';
        else
            result += c;
    }
    return key && result.starts_with('#') ? " " + result : result;
}

std::string header_of(const Volume& volume, VoxelType type, NrrdEncoding encoding) {
    const bool list = volume.components > 1;
    const auto& n = volume.dimensions;
    std::string text = fmt::format("NRRD0004\ntype: {}\ndimension: {}\n",
                                   type == VoxelType::f32   ? "float"
                                   : type == VoxelType::f64 ? "double"
                                                            : name_of(type),
                                   list ? 4 : 3);
    text += fmt::format("sizes: {}{} {} {}\n", list ? fmt::format("{} ", volume.components) : "", n[0], n[1], n[2]);
    const char* kind = !volume.has_own_colors ? "list " : volume.components == 3 ? "RGB-color " : "RGBA-color ";
    text += fmt::format("kinds: {}space space space\n", list ? kind : "");
    text += geometry_fields(volume);
    text += fmt::format("endian: little\nencoding: {}\n", encoding == NrrdEncoding::gzip ? "gzip" : "raw");
    for (const auto& [key, value] : volume.key_values) text += escaped(key, true) + ":=" + escaped(value, false) + "\n";
    if (!volume.modality.empty() && !volume.key_values.contains("modality"))
        text += "modality:=" + escaped(volume.modality, false) + "\n";
    return text + "\n";
}

/// Voxels in pieces, slope and intercept applied where `type` is not the stored one.
void for_each_piece(const Volume& volume, VoxelType type, const std::function<void(Bytes)>& take) {
    constexpr std::size_t piece = std::size_t(1) << 18;
    const bool stored = volume.slope == 1 && volume.intercept == 0;
    with_voxel_type(volume.type, [&](auto from) {
        with_voxel_type(type, [&](auto to) {
            const auto values = volume.as<decltype(from)>();
            std::vector<decltype(to)> converted(stored ? 0 : piece);
            for (std::size_t first = 0; first < values.size(); first += piece) {
                const auto part = values.subspan(first, std::min(piece, values.size() - first));
                if (stored) {
                    take(std::as_bytes(part));
                    continue;
                }
                std::transform(part.begin(), part.end(), converted.begin(), [&](auto v) {
                    return static_cast<decltype(to)>(volume.slope * double(v) + volume.intercept);
                });
                take(std::as_bytes(std::span(converted).first(part.size())));
            }
        });
    });
}

/// A gzip stream into a file.
class GzipWriter {
public:
    explicit GzipWriter(AtomicFile& file) : file_(file), buffer_(1 << 18) {
        constexpr int gzip_window = 15 + 16;
        if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_window, 8, Z_DEFAULT_STRATEGY) != Z_OK)
            throw Error(ErrorCode::output, "not enough memory to compress");
    }
    GzipWriter(const GzipWriter&) = delete;
    GzipWriter& operator=(const GzipWriter&) = delete;
    ~GzipWriter() { deflateEnd(&stream_); }

    void write(Bytes bytes) { push(bytes, Z_NO_FLUSH); }
    void finish() { push({}, Z_FINISH); }

private:
    void push(Bytes bytes, int flush) {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
        stream_.avail_in = uInt(bytes.size());
        do {
            stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
            stream_.avail_out = uInt(buffer_.size());
            deflate(&stream_, flush);
            file_.write(std::span(buffer_).first(buffer_.size() - stream_.avail_out));
        } while (stream_.avail_out == 0);
    }

    AtomicFile& file_;
    std::vector<std::byte> buffer_;
    z_stream stream_{};
};

}  // namespace

void write_nrrd(const Volume& volume, const std::filesystem::path& path, NrrdEncoding encoding) {
    Progress progress;
    write_nrrd(volume, path, encoding, progress);
}

void write_nrrd(const Volume& volume, const std::filesystem::path& path, NrrdEncoding encoding, Progress& progress) {
    std::size_t done = 0;
    const auto advance = [&](Bytes bytes) {
        progress.check();
        done += bytes.size();
        progress.report("write", std::min(1.0, double(done) / double(std::max<std::size_t>(1, volume.voxels.size()))));
    };
    const VoxelType type = written_type(volume);
    AtomicFile file(path);
    const std::string header = header_of(volume, type, encoding);
    file.write(std::as_bytes(std::span(header)));
    if (encoding == NrrdEncoding::raw) {
        for_each_piece(volume, type, [&](Bytes bytes) { advance(bytes), file.write(bytes); });
    } else {
        GzipWriter gzip(file);
        for_each_piece(volume, type, [&](Bytes bytes) { advance(bytes), gzip.write(bytes); });
        gzip.finish();
    }
    progress.check();
    file.commit();
}

}  // namespace chiaro
