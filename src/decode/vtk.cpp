// VTK's legacy structured points (https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html). Binary values
// are big endian, whatever machine wrote them.
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/text.h"
#include "decode/vtk_arrays.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

/// Lines and words of a file that holds binary data in between.
class MixedFile {
public:
    explicit MixedFile(const Path& path) : path_(path), size_(regular_file_size(path)) { go_to(0); }

    std::optional<std::string> line() {
        std::string text;
        for (int c = character(); c != '\n'; c = character()) {
            if (c < 0 && text.empty()) return {};
            if (c < 0) break;
            text += char(c);
            if (text.size() > 4096) refuse("has a line of more than 4096 characters in its header");
        }
        if (text.ends_with('\r')) text.pop_back();
        return text;
    }
    /// The next line that is not empty.
    std::optional<std::string> keyword_line() {
        for (auto text = line(); text; text = line())
            if (!trimmed(*text).empty()) return text;
        return {};
    }
    void skip_words(std::uint64_t count) {
        for (bool in_word = false; count > 0;) {
            const int c = character();
            if (c < 0 && (!in_word || count > 1)) refuse("ends within its values: the file is truncated");
            const bool blank = c < 0 || c == ' ' || c == '\n' || c == '\r' || c == '\t';
            count -= blank && in_word;
            in_word = !blank;
        }
    }
    void skip_bytes(std::uint64_t count) {
        if (count > size_ - position()) refuse("ends within its values: the file is truncated");
        go_to(position() + count);
    }
    std::uint64_t position() const { return read_ - (end_ - at_); }

private:
    void go_to(std::uint64_t offset) {
        source_ = open_plain(path_, offset);
        read_ = offset;
        at_ = end_ = 0;
    }
    int character() {
        if (at_ == end_) {
            end_ = source_->read(buffer_);
            at_ = 0;
            read_ += end_;
        }
        return at_ < end_ ? int(buffer_[at_++]) : -1;
    }

    Path path_;
    std::uint64_t size_, read_ = 0;  ///< bytes of the file up to the buffer's end
    std::unique_ptr<ByteSource> source_;
    std::array<std::byte, 65536> buffer_;
    std::size_t at_ = 0, end_ = 0;
};

struct Header {
    bool binary = false;
    std::array<std::int64_t, 3> points{0, 0, 0};
    Geometry geometry;
};

struct StoredArray {
    VtkArray array;
    std::int64_t tuples = 0;
    std::uint64_t offset = 0;
};

VoxelType vtk_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types = {
        {"char", VoxelType::i8},          {"signed_char", VoxelType::i8},     {"unsigned_char", VoxelType::u8},
        {"short", VoxelType::i16},        {"unsigned_short", VoxelType::u16}, {"int", VoxelType::i32},
        {"unsigned_int", VoxelType::u32}, {"long", VoxelType::i64},           {"unsigned_long", VoxelType::u64},
        {"vtktypeint64", VoxelType::i64}, {"vtktypeuint64", VoxelType::u64},  {"float", VoxelType::f32},
        {"double", VoxelType::f64}};
    const auto found = types.find(lower(name));
    if (found == types.end()) refuse("has an array of type '" + name + "', which is not one from char to double");
    return found->second;
}

std::int64_t count_from(const std::vector<std::string>& line, std::size_t at, std::int64_t most) {
    if (line.size() <= at) refuse("has a line '" + line.at(0) + "' without its count");
    const auto count = integer(line[at], line[0]);
    if (count < 0 || count > most) refuse(fmt::format("states {} for '{}'", count, line[0]));
    return count;
}

constexpr std::int64_t max_values = std::int64_t(1) << 40;

/// Walks through a file keyword by keyword, and keeps where the arrays lie.
class Walk {
public:
    explicit Walk(const Path& path) : file_(path) {
        const auto version = file_.line(), title = file_.line(), encoding = file_.line();
        if (!version || !version->starts_with("# vtk DataFile Version") || !title || !encoding)
            refuse("is no legacy VTK file");
        const std::string word = lower(trimmed(*encoding));
        if (word != "ascii" && word != "binary") refuse("is neither ASCII nor BINARY");
        header.binary = word == "binary";
        while (const auto text = file_.keyword_line()) take(words(*text));
        if (!found_dataset_) refuse("has no DATASET");
    }

    Header header;
    std::vector<StoredArray> arrays;

private:
    void take(const std::vector<std::string>& line) {
        const std::string word = lower(line[0]);
        if (word == "dataset") {
            found_dataset_ = true;
            if (line.size() < 2 || lower(line[1]) != "structured_points")
                refuse("holds a data set of kind '" + (line.size() < 2 ? "" : line[1]) + "', not STRUCTURED_POINTS");
        } else if (word == "dimensions" || word == "origin" || word == "spacing" || word == "aspect_ratio") {
            take_geometry(word, line);
        } else if (word == "point_data" || word == "cell_data") {
            of_cells_ = word == "cell_data";
            tuples_ = count_from(line, 1, max_values);
        } else if (word == "field") {
            for (auto n = count_from(line, 2, 4096); n > 0; --n) take_field_array();
        } else if (word == "metadata") {
            for (auto text = file_.line(); text && !trimmed(*text).empty();) text = file_.line();
        } else if (word == "lookup_table") {
            skip(VoxelType::u8, 4 * count_from(line, 2, 65536));
        } else {
            take_attribute(word, line);
        }
    }

    void take_geometry(const std::string& word, const std::vector<std::string>& line) {
        if (line.size() != 4) refuse(fmt::format("has {} words in its line '{}', not 4", line.size(), line[0]));
        if (!stated_.insert(word == "aspect_ratio" ? "spacing" : word).second)
            refuse(fmt::format("states its {} twice", word));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (word == "dimensions")
                header.points[axis] = integer(line[axis + 1], line[0]);
            else if (word == "origin")
                header.geometry.origin_mm[int(axis)] = number(line[axis + 1], line[0]);
            else
                header.geometry.spacing_mm[int(axis)] = number(line[axis + 1], line[0]);
        }
    }

    void take_field_array() {
        const auto text = file_.keyword_line();
        const auto line = text ? words(*text) : std::vector<std::string>{};
        if (line.empty()) refuse("ends within its field data: the file is truncated");
        if (lower(line[0]) == "metadata") {
            while (const auto rest = file_.line())
                if (trimmed(*rest).empty()) break;
            return take_field_array();
        }
        if (line.size() != 4) refuse("has a field array '" + line[0].substr(0, 40) + "' without its counts and type");
        const auto components = count_from(line, 1, 65535), tuples = count_from(line, 2, max_values);
        if (lower(line[3]) == "string") refuse("has the text array '" + line[0] + "', which cannot be skipped");
        add({.name = line[0], .type = vtk_type(line[3]), .components = components}, tuples);
    }

    void take_attribute(const std::string& word, const std::vector<std::string>& line) {
        if (tuples_ < 0) refuse("has an unknown keyword '" + line[0].substr(0, 40) + "'");
        if (line.size() < 3) refuse("has a line '" + line[0].substr(0, 40) + "' without name and type");
        VtkArray array{.name = line[1]};
        if (word == "scalars") {
            array.active = true;
            array.type = vtk_type(line[2]);
            array.components = line.size() > 3 ? count_from(line, 3, 65535) : 1;
            const auto table = file_.line();
            if (!table || !lower(*table).starts_with("lookup_table")) refuse("has SCALARS without LOOKUP_TABLE");
        } else if (word == "color_scalars") {
            array.components = count_from(line, 2, 65535);
            array.type = header.binary ? VoxelType::u8 : VoxelType::f32;
            array.are_colors = true;
        } else if (word == "vectors" || word == "normals" || word == "tensors") {
            array.type = vtk_type(line[2]);
            array.components = word == "tensors" ? 9 : 3;
        } else if (word == "texture_coordinates") {
            if (line.size() < 4) refuse("has TEXTURE_COORDINATES without a type");
            array.components = count_from(line, 2, 3);
            array.type = vtk_type(line[3]);
        } else {
            refuse("has an unknown keyword '" + line[0].substr(0, 40) + "'");
        }
        add(array, tuples_);
    }

    /// Notes where an array begins, and goes on behind it. What belongs to no points or cells is only skipped.
    void add(VtkArray array, std::int64_t tuples) {
        array.of_cells = of_cells_;
        if (tuples_ >= 0) arrays.push_back({array, tuples, file_.position()});
        skip(array.type, tuples * array.components);
    }

    void skip(VoxelType type, std::int64_t values) {
        header.binary ? file_.skip_bytes(std::uint64_t(values) * size_of(type))
                      : file_.skip_words(std::uint64_t(values));
    }

    MixedFile file_;
    std::set<std::string> stated_;  ///< of the lines that there is one of
    bool found_dataset_ = false, of_cells_ = false;
    std::int64_t tuples_ = -1;  ///< of the point or cell data at hand; -1 before any
};

}  // namespace

Volume read_vtk(const Path& path, const std::string&, Output& output) {
    const Walk walk(path);
    Volume volume;
    volume.format = "VTK";
    volume.geometry = walk.header.geometry;
    check_geometry(volume.geometry);
    std::vector<VtkArray> arrays;
    for (const auto& stored : walk.arrays) arrays.push_back(stored.array);
    const StoredArray& chosen = walk.arrays[choose_array(arrays, volume)];
    set_shape(chosen.array, walk.header.points, volume);
    if (std::uint64_t(chosen.tuples) != volume.voxel_count())
        refuse(fmt::format("states {} values in the array '{}' where its dimensions need {}", chosen.tuples,
                           chosen.array.name, volume.voxel_count()));
    Payload payload;
    payload.files = {path};
    payload.offset = chosen.offset;
    payload.encoding = walk.header.binary ? Encoding::raw : Encoding::text;
    payload.big_endian = true;
    payload.more_may_follow = true;
    read_voxels(payload, volume, output);
    return volume;
}

}  // namespace chiaro::decode
