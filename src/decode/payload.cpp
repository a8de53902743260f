#include "decode/payload.h"

#include "decode/moment_source.h"
#include "decode/text.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace chiaro::decode {
namespace {

std::uint64_t capacity_of(const Payload& payload, VoxelType type) {
    std::uint64_t available = 0;
    for (const auto& file : payload.files) {
        const std::uint64_t size = regular_file_size(file);
        available += size - std::min(size, payload.offset);
    }
    if (payload.encoding == Encoding::deflated) return available * largest_deflate_ratio;
    if (payload.encoding == Encoding::text) return (available + 1) / 2 * size_of(type);  // a digit and a blank each
    return available;
}

/// Numbers as text, separated by blanks or commas.
class TextReader {
public:
    explicit TextReader(ByteSource& source) : source_(source) {}

    std::string next() {
        std::string word;
        for (char c; (c = character()) != 0;) {
            const bool separator = is_separator(c);
            ends_behind_digit_ = !separator;
            if (separator && !word.empty()) return word;
            if (!separator) word += c;
            if (word.size() > 64) refuse("holds a number of more than 64 characters");
        }
        if (word.empty()) refuse("its text data end before the last voxel");
        return word;
    }

    /// Behind the number read last.
    TextEnd end() {
        for (char c; (c = character()) != 0;)
            if (!is_separator(c)) return {.has_more = true};
        return {.behind_digit = ends_behind_digit_};
    }

private:
    static bool is_separator(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == ','; }

    char character() {
        if (at_ == end_) {
            end_ = source_.read(buffer_);
            at_ = 0;
        }
        return at_ < end_ ? char(buffer_[at_++]) : 0;
    }

    ByteSource& source_;
    std::array<std::byte, 65536> buffer_;
    std::size_t at_ = 0, end_ = 0;
    bool ends_behind_digit_ = false;
};

template <class T>
T value_from(const std::string& word) {
    if constexpr (std::is_floating_point_v<T>) {
        return T(number(word, "data"));
    } else {
        T value{};
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc{} || end != word.data() + word.size())
            refuse("holds '" + word + "', which is no value of its type");
        return value;
    }
}

}  // namespace

void check_capacity(std::uint64_t bytes, std::uint64_t most) {
    if (bytes > most)
        refuse(fmt::format(
            "its header states {} bytes of voxels, but the file can hold at most {}: truncated, or a wrong header",
            bytes, most));
}

TextEnd fill_from_text(ByteSource& source, VoxelType type, std::span<std::byte> to, Output& output,
                       const MomentAxis& moments) {
    TextReader reader(source);
    with_voxel_type(type, [&](auto zero) {
        using T = decltype(zero);
        auto* values = reinterpret_cast<T*>(to.data());
        const std::size_t count = to.size() / sizeof(T), run = std::max<std::size_t>(1, moments.run / sizeof(T));
        for (std::size_t i = 0, kept = 0; kept < count; ++i) {
            const std::string word = reader.next();
            if (i / run % moments.count != moments.wanted) continue;
            values[kept++] = value_from<T>(word);
            if (kept % 65536 == 0) output.progress(double(kept) / double(count));
        }
    });
    return reader.end();
}

void fill_from_bytes(ByteSource& source, bool big_endian, VoxelType type, std::span<std::byte> to, Output& output) {
    constexpr std::size_t piece_size = std::size_t(4) << 20;
    for (std::size_t done = 0; done < to.size();) {
        const auto piece = to.subspan(done, std::min(piece_size, to.size() - done));
        const std::size_t got = source.read(piece);
        done += got;
        if (got < piece.size())
            refuse(fmt::format("its header states {} bytes of voxels, but only {} are there: the file is truncated",
                               to.size(), done));
        if (big_endian) swap_bytes(piece, size_of(type));
        output.progress(double(done) / double(to.size()));
    }
}

namespace {

constexpr const char* more_behind = "there are more data behind the last voxel; they are ignored";

/// Reading on to the end of a compressed stream checks its checksum; anything more than that is worth a note.
void check_end(ByteSource& source, Volume& volume) {
    std::byte extra[1];
    if (source.read(extra) != 0) volume.notes.push_back(more_behind);
}

/// Where they lie, if in one file as they are and all of them.
std::optional<VoxelsInFile> place_of(const Payload& payload, std::uint64_t bytes) {
    const MomentAxis& moments = payload.moments;
    if (payload.encoding != Encoding::raw || payload.files.size() != 1 || payload.files[0] == standard_input ||
        (moments.count > 1 && moments.run != bytes))
        return {};
    const std::uint64_t before = moments.count > 1 ? moments.wanted * bytes : 0;
    const std::uint64_t offset = payload.offset + payload.skip + before, size = regular_file_size(payload.files[0]);
    if (size < offset || size - offset < bytes) return {};
    return VoxelsInFile{payload.files[0], offset, payload.big_endian};
}

}  // namespace

void read_voxels(const Payload& payload, Volume& volume, Output& output) {
    const auto& n = volume.dimensions;
    const std::uint64_t bytes = checked_bytes({n[0], n[1], n[2]}, volume.components, volume.type);
    std::uint64_t stated = 0;
    if (__builtin_mul_overflow(bytes, payload.volumes, &stated))
        refuse("states more voxels than can be counted in 64 bits");
    if (payload.files.empty() || stated % (payload.files.size() * size_of(volume.type)) != 0)
        refuse(fmt::format("has {} data files, which {} slices cannot be shared among", payload.files.size(), n[2]));
    check_capacity(stated, capacity_of(payload, volume.type));
    if (const auto place = place_of(payload, bytes);
        place && output.takes_place() && (!output.asks_for_place() || volume.components == 1)) {
        output.lie_at(volume, *place);
        if (payload.volumes == 1 && !payload.more_may_follow)
            check_end(*open_plain(place->path, place->offset + bytes), volume);
        return;
    }
    output.allocate(volume);
    if (payload.moments.count > 1 && payload.encoding == Encoding::text && payload.files.size() > 1)
        refuse("spreads several moments over several files of text, which is not supported");
    if (payload.moments.count > 1 && payload.encoding != Encoding::text) {
        const auto source = open_moment(payload, stated / payload.files.size());
        return fill_from_bytes(*source, payload.big_endian, volume.type,
                               std::span(volume.voxels.data(), volume.voxels.size()), output);
    }
    const std::size_t share = bytes / payload.files.size();
    TextEnd end;
    for (std::size_t i = 0; i < payload.files.size(); ++i) {
        const bool deflated = payload.encoding == Encoding::deflated;
        const auto source =
            deflated ? open_deflated(payload.files[i], payload.offset) : open_plain(payload.files[i], payload.offset);
        skip(*source, payload.skip);
        const std::span<std::byte> to(volume.voxels.data() + i * share, share);
        if (payload.encoding == Encoding::text)
            end = fill_from_text(*source, volume.type, to, output, payload.moments);
        else
            fill_from_bytes(*source, payload.big_endian, volume.type, to, output);
        if (payload.encoding != Encoding::text && payload.volumes == 1 && !payload.more_may_follow)
            check_end(*source, volume);
    }
    if (end.has_more && payload.volumes == 1 && !payload.more_may_follow) volume.notes.push_back(more_behind);
    if (end.behind_digit)
        volume.notes.push_back("no line end follows the last number: it may be cut, and the file with it");
}

void swap_bytes(std::span<std::byte> bytes, std::size_t value_size) {
    const auto swap = [&]<class T>(T, auto swapped) {
        auto* values = reinterpret_cast<T*>(bytes.data());
        for (std::size_t i = 0; i < bytes.size() / sizeof(T); ++i) values[i] = swapped(values[i]);
    };
    if (value_size == 2) swap(std::uint16_t{}, [](std::uint16_t v) { return __builtin_bswap16(v); });
    if (value_size == 4) swap(std::uint32_t{}, [](std::uint32_t v) { return __builtin_bswap32(v); });
    if (value_size == 8) swap(std::uint64_t{}, [](std::uint64_t v) { return __builtin_bswap64(v); });
}

std::filesystem::path confined(const std::filesystem::path& header, const std::string& name) {
    if (header == standard_input) refuse(fmt::format("names the data file '{}', but must hold its data itself", name));
    if (name.find('\0') != name.npos) refuse("names a data file with a NUL in its name");
    const std::filesystem::path relative(name);
    const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
    std::error_code error;
    const auto folder = std::filesystem::canonical(header.parent_path().empty() ? "." : header.parent_path(), error);
    const auto file = std::filesystem::weakly_canonical(folder / relative, error);
    const bool inside = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
    if (relative.empty() || relative.is_absolute() || climbs || error || !inside)
        refuse(fmt::format("names the data file '{}', but data files must lie in the folder of the header or below it",
                           name));
    return file;
}

std::vector<std::string> expand_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                        std::int64_t step) {
    const auto percent = pattern.find('%');
    const auto conversion = pattern.find_first_not_of("0123456789", percent + 1);
    if (percent == std::string::npos || conversion == std::string::npos || pattern[conversion] != 'd' ||
        pattern.find('%', conversion) != std::string::npos || conversion - percent > 3)
        refuse(fmt::format("names its data files '{}', which is no pattern with one %d", pattern));
    if (step < 1 || step > 65535 || first < 0 || last < first || (last - first) / step > 65535)
        refuse(fmt::format("numbers its data files from {} to {} by {}", first, last, step));
    const std::string digits = pattern.substr(percent + 1, conversion - percent - 1);
    const int width = digits.empty() ? 0 : int(integer(digits, "data file"));
    std::vector<std::string> names;
    for (std::int64_t n = 0; n <= (last - first) / step; ++n) {
        const std::int64_t i = first + n * step;  // never beyond `last`, so without overflow
        const std::string index =
            digits.starts_with('0') ? fmt::format("{:0{}}", i, width) : fmt::format("{:{}}", i, width);
        names.push_back(pattern.substr(0, percent) + index + pattern.substr(conversion + 1));
    }
    return names;
}

}  // namespace chiaro::decode
