#include "io/raw.h"

#include "core/text.h"
#include "core/threads.h"
#include "core/truncated_file.h"
#include "io/helper_process.h"
#include "io/memory.h"
#include "io/spill.h"
#include "volume/spare_memory.h"
#include "volume/validate.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace chiaro {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& sentence) {
    throw Error(ErrorCode::input, "cannot read '" + one_line(path.string()) + "': " + sentence);
}

std::optional<VoxelType> type_named(std::string_view word) {
    for (int i = 0; i <= int(VoxelType::f64); ++i)
        if (word == name_of(VoxelType(i))) return VoxelType(i);
    constexpr std::pair<std::string_view, VoxelType> others[] = {{"uchar", VoxelType::u8},
                                                                 {"ushort", VoxelType::u16},
                                                                 {"short", VoxelType::i16},
                                                                 {"float", VoxelType::f32},
                                                                 {"double", VoxelType::f64}};
    for (const auto& [name, type] : others)
        if (word == name) return type;
    return {};
}

constexpr std::string_view separators = "_-.";
bool is_separator(char c) { return separators.find(c) != std::string_view::npos; }

/// "64x64x32"
std::optional<std::array<int, 3>> dimensions_from(std::string_view word) {
    std::array<int, 3> n{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n[i]);
        if (error != std::errc{}) return {};
        word.remove_prefix(std::size_t(end - word.data()));
        if (word.empty() != (i == 2)) return {};
        if (i < 2 && word[0] != 'x') return {};
        if (i < 2) word.remove_prefix(1);
    }
    return n;
}

void swap_all(Volume& volume) {
    with_voxel_type(volume.type, [&](auto zero) {
        constexpr std::int64_t size = sizeof zero;
        std::byte* bytes = volume.voxels.data();
        parallel_for(std::int64_t(volume.voxel_count()) * volume.components, 1 << 20,
                     [=](std::int64_t first, std::int64_t last) {
                         for (auto i = first; i < last; ++i) std::reverse(bytes + i * size, bytes + (i + 1) * size);
                     });
    });
}

}  // namespace

void read_in_place(const VoxelsInFile& place, Volume& volume, Progress& progress) {
    const auto& [path, offset, big_endian] = place;
    VoxelBuffer& to = volume.voxels;
    const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.number() < 0) refuse(path, "it cannot be opened");
    constexpr std::size_t piece = std::size_t(16) << 20;
    for (std::size_t done = 0; done < to.size();) {
        progress.check();
        const ssize_t n =
            pread(file.number(), to.data() + done, std::min(piece, to.size() - done), off_t(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) refuse(path, n < 0 ? "reading it fails half-way" : was_cut);
        done += std::size_t(n);
        progress.report("read", double(done) / double(to.size()));
    }
    if (is_cut(file.number(), offset + to.size())) refuse(path, was_cut);
    if (big_endian) swap_all(volume);
}

RawLayout completed_layout(RawLayout layout, const std::string& name) {
    const std::string stem = name.substr(0, name.rfind('.'));
    for (std::size_t at = 0; at <= stem.size();) {
        const auto end = std::min(stem.find_first_of(separators, at), stem.size());
        const std::string_view word = std::string_view(stem).substr(at, end - at);
        // A minus behind another separator is a sign, and no size is negative.
        const bool negative = at > 0 && stem[at - 1] == '-' && (at == 1 || is_separator(stem[at - 2]));
        if (!layout.dimensions && !negative) layout.dimensions = dimensions_from(word);
        if (!layout.type) layout.type = type_named(word);
        at = end + 1;
    }
    return layout;
}

RawFile examine_raw(const std::filesystem::path& path, const ReadOptions& options) {
    const RawLayout layout = completed_layout(options.raw, path.filename().string());
    if (!layout.dimensions || !layout.type)
        refuse(path,
               "a raw file needs its size and type, by --raw-size 64x64x64 --raw-type uint8 or in a name such as "
               "a_64x64x64_uint8.raw");
    RawFile raw{.volume = {}, .layout = layout};
    raw.volume.format = "raw";
    raw.volume.dimensions = *layout.dimensions;
    raw.volume.type = *layout.type;
    raw.volume.geometry.spacing_mm = layout.spacing_mm.value_or(Vec3{1, 1, 1});
    const auto& n = raw.volume.dimensions;
    try {
        raw.bytes = checked_bytes({n[0], n[1], n[2]}, 1, raw.volume.type);
        check_geometry(raw.volume.geometry);
    } catch (const Error& error) {
        refuse(path, error.what());
    }
    struct stat status {};
    if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) refuse(path, "it is not a regular file");
    if (const auto size = std::uint64_t(status.st_size); size < layout.offset || size - layout.offset != raw.bytes)
        refuse(path, fmt::format("it has {} bytes, but {} x {} x {} {} voxels behind {} bytes of header need {}", size,
                                 n[0], n[1], n[2], name_of(raw.volume.type), layout.offset, raw.bytes + layout.offset));
    return raw;
}

Volume read_raw(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
    auto [volume, layout, bytes] = examine_raw(path, options);
    const auto room = memory_within(options.max_bytes);
    if (bytes > room && bytes > free_disk_bytes(options.spill))
        refuse(path, fmt::format("its voxels take {} MiB, but at most {} MiB may be used", bytes >> 20, room >> 20));
    volume.voxels = bytes > room ? make_spilled_voxels(options.spill, bytes) : unspecified_bytes(bytes);
    read_in_place({path, layout.offset, layout.big_endian}, volume, progress);
    return std::move(volume);
}

}  // namespace chiaro
