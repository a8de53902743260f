#include "decode/vdb_file.h"

#include <openvdb/io/Compression.h>
#include <openvdb/math/Transform.h>

#include <algorithm>
#include <set>

namespace chiaro::decode {
namespace {

constexpr std::string_view half_ending = "_HalfFloat", vdb_magic(" BDV\0\0\0\0", 8);
constexpr std::uint32_t longest_name = 4096;

/// As the library shows names: where several grids have one, the file has "name\x1e1".
std::string shown_name(const std::string& unique) {
    const auto mark = unique.find('\x1e');
    return mark == unique.npos ? unique : unique.substr(0, mark) + "[" + unique.substr(mark + 1) + "]";
}

VdbGrid read_entry(VdbStream& stream) {
    VdbGrid grid;
    grid.name = shown_name(stream.text(longest_name));
    grid.type = stream.text(longest_name);
    grid.tree_of = shown_name(stream.text(longest_name));
    grid.is_half = grid.type.ends_with(half_ending);
    if (grid.is_half) grid.type.resize(grid.type.size() - half_ending.size());
    for (std::uint64_t* place : {&grid.begin, &grid.blocks, &grid.end}) *place = stream.number<std::uint64_t>();
    return grid;
}

/// Places follow each other within the file: so reading them comes to an end.
void check_entry(VdbStream& stream, const VdbGrid& grid) {
    if (grid.end > stream.size())
        refuse(fmt::format("is cut short: its grid '{}' ends at byte {}, the file at {}", grid.name, grid.end,
                           stream.size()));
    const bool has_blocks = grid.tree_of.empty();
    if (grid.begin != stream.position() || grid.end < grid.begin ||
        (has_blocks && (grid.blocks < grid.begin || grid.end < grid.blocks)))
        refuse(fmt::format("has a grid '{}' that lies nowhere: its table of contents is damaged", grid.name));
}

/// Goes past all metadata; returns the text that one of them holds, "" where there is none of that name.
std::string text_of_metadata(VdbStream& stream, std::string_view wanted) {
    std::string text;
    const auto count = stream.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string name = stream.text(longest_name), type = stream.text(longest_name);
        if (name == wanted && type == "string")
            text = stream.text(longest_name);
        else
            stream.skip(stream.number<std::uint32_t>());
    }
    return text;
}

bool is_scalar(const VdbGrid& grid) { return grid.type == vdb_float_tree || grid.type == vdb_double_tree; }

/// What a grid holds that is not read.
std::string kind_of(const VdbGrid& grid) {
    for (const auto& [beginning, kind] :
         {std::pair("Tree_vec", "vectors"), std::pair("Tree_bool", "truth values"), std::pair("Tree_mask", "a mask"),
          std::pair("Tree_int", "integers"), std::pair("Tree_pt", "points"), std::pair("Tree_string", "texts")})
        if (grid.type.starts_with(beginning)) return kind;
    return "a tree of type '" + grid.type + "'";
}

std::string list_of_grids(const std::vector<VdbGrid>& grids) {
    constexpr std::size_t max_listed = 16;
    std::string list;
    for (std::size_t i = 0; i < std::min(grids.size(), max_listed); ++i)
        list += fmt::format("{}{}{}", i > 0 ? ", " : "", grids[i].name,
                            is_scalar(grids[i]) ? "" : " (" + kind_of(grids[i]) + ")");
    return list + (grids.size() > max_listed ? ", ..." : "");
}

/// The maps that are affine.
void register_maps() {
    using namespace openvdb::math;
    if (MapRegistry::isRegistered(AffineMap::mapType())) return;
    UniformScaleMap::registerMap(), ScaleMap::registerMap(), UniformScaleTranslateMap::registerMap(),
        ScaleTranslateMap::registerMap(), TranslationMap::registerMap(), UnitaryMap::registerMap(),
        AffineMap::registerMap();
}

}  // namespace

VdbContents read_contents(VdbStream& stream) {
    VdbContents contents;
    const auto start = stream.number<std::array<char, 8>>();
    if (std::string_view(start.data(), start.size()) != vdb_magic) refuse("is no OpenVDB file");
    contents.version = stream.number<std::uint32_t>();
    if (contents.version < oldest_vdb || contents.version > newest_vdb)
        refuse(fmt::format("is of version {} of OpenVDB's format; {} to {} are read", contents.version, oldest_vdb,
                           newest_vdb));
    stream.skip(8);  // the version of the library that wrote it
    if (!stream.number<std::uint8_t>())
        refuse("was written as a stream, without the places of its grids; only files that have them are read");
    if (contents.version < vdb_of_masks && stream.number<std::uint8_t>())
        contents.compression = openvdb::io::COMPRESS_ZIP;
    stream.skip(36);  // a random number, as text
    text_of_metadata(stream, "");
    const auto count = stream.number<std::int32_t>();
    constexpr int max_grids = 10000;
    if (count < 1 || count > max_grids) refuse(fmt::format("states {} grids, not 1 to {}", count, max_grids));
    std::set<std::string> names;
    for (int i = 0; i < count; ++i) {
        VdbGrid grid = read_entry(stream);
        check_entry(stream, grid);
        if (!names.insert(grid.name).second) refuse(fmt::format("has two grids '{}'", grid.name));
        stream.go_to(grid.end);
        contents.grids.push_back(std::move(grid));
    }
    return contents;
}

const VdbGrid& chosen_grid(const VdbContents& contents, const std::string& part, Volume& header) {
    const auto& grids = contents.grids;
    const auto is_named = [&](const VdbGrid& grid) { return grid.name == part || "/" + grid.name == part; };
    const auto found = part.empty() ? std::ranges::find_if(grids, is_scalar) : std::ranges::find_if(grids, is_named);
    if (found == grids.end())
        refuse(part.empty() ? fmt::format("holds no grid of floats, but {}", list_of_grids(grids))
                            : fmt::format("holds no grid '{}', but {}", part.substr(1), list_of_grids(grids)));
    if (!is_scalar(*found))
        refuse(fmt::format("holds in its grid '{}' {}; grids of one float or double a voxel are read", found->name,
                           kind_of(*found)));
    header.format = "OpenVDB";
    header.key_values["grid"] = found->name;
    if (grids.size() > 1)
        header.notes.push_back(fmt::format("holds {} grids; '{}' is shown (FILE#NAME is another): {}", grids.size(),
                                           found->name, list_of_grids(grids)));
    return *found;
}

const VdbGrid& owner_of_tree(const VdbContents& contents, const VdbGrid& grid) {
    if (grid.tree_of.empty()) return grid;
    const auto owner = std::ranges::find(contents.grids, grid.tree_of, &VdbGrid::name);
    if (owner == contents.grids.end() || !owner->tree_of.empty() || owner->type != grid.type)
        refuse(fmt::format("has a grid '{}' that shares the tree of '{}', which has none of its kind", grid.name,
                           grid.tree_of));
    return *owner;
}

VdbPlacement read_placement(VdbStream& stream, const VdbContents& contents, const VdbGrid& grid) {
    stream.go_to(grid.begin);
    VdbPlacement placement{.compression = contents.compression};
    if (contents.version >= vdb_of_masks) placement.compression = stream.number<std::uint32_t>();
    using namespace openvdb;
    if (placement.compression & ~std::uint32_t(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK | io::COMPRESS_BLOSC))
        refuse(
            fmt::format("has a grid '{}' that is compressed in an unknown way ({})", grid.name, placement.compression));
    placement.is_level_set = text_of_metadata(stream, "class") == "level set";
    const std::uint64_t begin = stream.position();
    const std::string type = stream.text(longest_name);
    register_maps();
    if (!math::MapRegistry::isRegistered(type))
        refuse(fmt::format("has a grid '{}' whose transform is a {}; those that are affine are read", grid.name,
                           type.find("Frustum") == type.npos ? "'" + type + "'" : "frustum"));
    stream.go_to(begin);
    io::setVersion(stream, {0, 0}, contents.version);  // by which the library reads all that follows
    const math::Mat4d matrix = by_library("a transform", [&] {
        math::Transform transform;
        transform.read(stream);
        return transform.baseMap()->getAffineMap()->getMat4();
    });
    const auto row = [&](int i) { return Vec3{matrix(i, 0), matrix(i, 1), matrix(i, 2)}; };  // world = index M
    placement.steps = {row(0), row(1), row(2)};
    placement.origin = row(3);
    return placement;
}

}  // namespace chiaro::decode
