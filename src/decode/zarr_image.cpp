#include "decode/zarr_image.h"

#include "decode/text.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace chiaro::decode {
namespace {

using nlohmann::json;

/// Millimetres; none for a unit that is not known.
std::optional<double> millimetres(const std::string& unit) {
    static const std::map<std::string, double> units = {
        {"angstrom", 1e-7}, {"picometer", 1e-9}, {"nanometer", 1e-6}, {"micrometer", 1e-3}, {"millimeter", 1},
        {"centimeter", 10}, {"decimeter", 100},  {"meter", 1000},     {"kilometer", 1e6},   {"inch", 25.4},
        {"foot", 304.8},    {"yard", 914.4},     {"micron", 1e-3},    {"um", 1e-3},         {"nm", 1e-6},
        {"mm", 1},          {"\xc2\xb5m", 1e-3}};
    const auto found = units.find(unit);
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

struct Axis {
    std::string name, type, unit;
};

/// Index to place along each axis: scale * index + shift.
struct Placing {
    std::vector<double> scale, shift;
};

std::vector<double> numbers_of(const json& list, std::size_t axes, const std::string& what) {
    if (!list.is_array() || list.size() != axes)
        refuse(fmt::format("states a {} that is no list of a number for each axis", what));
    return list.get<std::vector<double>>();
}

void add_transforms(const json& transforms, Placing& placing) {
    const std::size_t axes = placing.scale.size();
    for (const json& transform : transforms) {
        const auto type = transform.at("type").get<std::string>();
        if (type == "identity") continue;
        if (type != "scale" && type != "translation")
            refuse(fmt::format("places its voxels by a '{}', which is not read", type));
        if (!transform.contains(type)) refuse(fmt::format("has a {} in another file, which is not read", type));
        const auto by = numbers_of(transform.at(type), axes, type);
        for (std::size_t axis = 0; axis < axes; ++axis) {
            if (type == "scale")
                placing.scale[axis] *= by[axis], placing.shift[axis] *= by[axis];
            else
                placing.shift[axis] += by[axis];
        }
    }
}

/// The `multiscales` of a group; null where there is none. In version 0.5 attributes lie in `ome`.
json multiscales_of(const json& attributes) {
    const json& ome = attributes.contains("ome") ? attributes.at("ome") : attributes;
    const auto found = ome.find("multiscales");
    return found != ome.end() && found->is_array() && !found->empty() ? *found : json();
}

std::vector<Axis> axes_of(const json& multiscale, std::size_t count) {
    std::vector<Axis> axes;
    const auto stated = multiscale.find("axes");
    if (stated == multiscale.end()) {  // before version 0.3
        for (const char* name : {"t", "c", "z", "y", "x"}) axes.push_back({name, "", ""});
        axes.erase(axes.begin(), axes.begin() + std::ptrdiff_t(5 - std::min<std::size_t>(5, count)));
    } else {
        for (const json& axis : *stated)
            axes.push_back(axis.is_string()
                               ? Axis{axis.get<std::string>(), "", ""}
                               : Axis{axis.at("name").get<std::string>(), axis.value("type", std::string()),
                                      axis.value("unit", std::string())});
    }
    if (axes.size() != count) refuse(fmt::format("states {} axes of an array that has {}", axes.size(), count));
    for (Axis& axis : axes)
        if (axis.type.empty()) axis.type = axis.name == "t" ? "time" : axis.name == "c" ? "channel" : "space";
    return axes;
}

/// By their names where they are x, y and z, else the last one is x.
void find_space(const std::vector<Axis>& axes, ZarrImage& image) {
    std::vector<int> space;
    bool are_named = true;
    for (std::size_t i = 0; i < axes.size(); ++i)
        if (axes[i].type == "space") {
            space.push_back(int(i));
            are_named =
                are_named && axes[i].name.size() == 1 && std::string("xyz").find(axes[i].name) != std::string::npos;
        }
    if (space.size() < 2 || space.size() > 3)
        refuse(fmt::format("has {} axes in space; volumes have three", space.size()));
    for (std::size_t i = 0; i < space.size(); ++i) {
        const int axis = space[space.size() - 1 - i];
        int& place = image.space[are_named ? std::size_t(axes[std::size_t(axis)].name[0] - 'x') : i];
        if (place >= 0) refuse(fmt::format("states the axis '{}' twice", axes[std::size_t(axis)].name));
        place = axis;
    }
    if (image.space[0] < 0 || image.space[1] < 0) refuse("has no axes x and y");
}

void find_axes(const std::vector<Axis>& axes, const ZarrArray& array, ZarrImage& image) {
    find_space(axes, image);
    for (std::size_t i = 0; i < axes.size(); ++i) {
        if (axes[i].type == "space") continue;
        if (axes[i].type == "time" && image.time < 0)
            image.time = int(i);
        else if (axes[i].type == "channel" && image.channel < 0)
            image.channel = int(i);
        else if (array.shape[i] != 1)
            refuse(fmt::format("has {} places along its axis '{}', which is neither space, time nor channel",
                               array.shape[i], axes[i].name));
    }
}

std::array<std::int64_t, 3> dimensions_of(const ZarrImage& image, const ZarrArray& array) {
    std::array<std::int64_t, 3> n{1, 1, 1};
    for (std::size_t a = 0; a < 3; ++a)
        if (image.space[a] >= 0) n[a] = array.shape[std::size_t(image.space[a])];
    return n;
}

Geometry geometry_of(const ZarrImage& image, const std::vector<Axis>& axes, const Placing& placing) {
    Geometry geometry;
    for (std::size_t a = 0; a < 3; ++a) {
        if (image.space[a] < 0) {
            geometry.spacing_mm[int(a)] = geometry.spacing_mm.x;
            continue;
        }
        const auto axis = std::size_t(image.space[a]);
        const double mm = millimetres(axes[axis].unit).value_or(1);
        geometry.spacing_mm[int(a)] = mm * placing.scale[axis];
        geometry.origin_mm[int(a)] = mm * placing.shift[axis];
    }
    return geometry;
}

/// One moment and one channel, or all of few channels.
void choose_moment(const std::vector<Axis>& axes, const Placing& placing, const Output& output, ZarrImage& image) {
    if (image.time < 0) return;
    const auto axis = std::size_t(image.time);
    static const std::map<std::string, std::string> units = {
        {"second", "s"}, {"millisecond", "ms"}, {"microsecond", "us"}, {"minute", "min"}, {"hour", "h"}, {"day", "d"}};
    output.choose_moment(std::uint64_t(image.levels[0].shape[axis]), image.header);
    const auto unit = units.find(axes[axis].unit);
    if (unit != units.end())
        set_even_times(image.header.moments, placing.shift[axis], placing.scale[axis], unit->second);
}

/// "FF0080"; nothing for other texts.
std::optional<std::array<double, 3>> color_of(const std::string& text) {
    std::uint32_t rgb = 0;
    const char* const end = text.data() + text.size();
    if (text.size() != 6 || std::from_chars(text.data(), end, rgb, 16).ptr != end) return {};
    return std::array{(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0};
}

/// What is said of the channels; empty: nothing.
std::vector<ComponentInfo> channel_infos(const json& attributes) {
    std::vector<ComponentInfo> infos;
    const json& ome = attributes.contains("ome") ? attributes.at("ome") : attributes;
    if (!ome.contains("omero") || !ome.at("omero").is_object()) return infos;
    for (const json& channel : ome.at("omero").value("channels", json::array()))
        infos.push_back({channel.value("label", std::to_string(infos.size())), color_of(channel.value("color", ""))});
    return infos;
}

void choose_channel(const std::string& wanted, const json& attributes, ZarrImage& image) {
    constexpr std::int64_t max_shown = 8;
    const std::int64_t count = image.channel < 0 ? 1 : image.levels[0].shape[std::size_t(image.channel)];
    std::vector<ComponentInfo> infos = channel_infos(attributes);
    std::vector<std::string> names;
    for (const ComponentInfo& info : infos) names.push_back(info.name);
    if (!wanted.empty()) {
        const auto named = std::ranges::find(names, wanted);
        int number = int(named - names.begin());
        const char* end = wanted.data() + wanted.size();
        if (named == names.end() && std::from_chars(wanted.data(), end, number).ptr != end) number = -1;
        if (number < 0 || number >= count)
            refuse(fmt::format("has no channel '{}', but {}, counted from 0{}{}", wanted, count,
                               names.empty() ? "" : ": ", fmt::join(names, ", ")));
        image.first_channel = number;
        return;
    }
    if (count == 1) return;
    const std::string list = names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "));
    if (count <= max_shown) {
        image.header.components = int(count);
        infos.resize(infos.empty() ? 0 : std::size_t(count));
        image.header.component_infos = std::move(infos);
        image.header.notes.push_back(
            fmt::format("holds {} channels{}; STORE#PATH@N is one of them, from 0", count, list));
    } else {
        image.header.notes.push_back(
            fmt::format("holds {} channels{}; the first is shown (STORE#PATH@N is another, from 0)", count, list));
    }
}

void add_level(const std::vector<Axis>& axes, const Placing& placing, ZarrArray array, ZarrImage& image) {
    const auto n = dimensions_of(image, array);
    checked_bytes(n, 1, array.type);
    if (!image.levels.empty()) {
        const auto finer = dimensions_of(image, image.levels.back());
        if (array.type != image.levels[0].type || array.shape.size() != image.levels[0].shape.size())
            refuse(fmt::format("has a level '{}' of another kind than its first", array.path));
        if (n[0] > finer[0] || n[1] > finer[1] || n[2] > finer[2])
            refuse(fmt::format("has a level '{}' with more voxels than the one before it", array.path));
        for (const int axis : {image.time, image.channel})
            if (axis >= 0 && array.shape[std::size_t(axis)] != image.levels[0].shape[std::size_t(axis)])
                refuse(fmt::format("has a level '{}' with other moments or channels than its first", array.path));
    }
    const Geometry geometry = geometry_of(image, axes, placing);
    check_geometry(geometry);
    image.geometries.push_back(geometry);
    image.levels.push_back(std::move(array));
}

/// Of one of the array's own axes' names, where it has them.
std::vector<Axis> axes_of_array(const ZarrArray& array) {
    std::vector<Axis> axes(array.shape.size());
    std::size_t space = 0;
    for (std::size_t i = array.shape.size(); i-- > 0;) {
        const std::string name = array.names.empty() ? "" : lower(array.names[i]);
        axes[i].name = name.empty() ? std::to_string(i) : name;
        axes[i].type = name == "t" || name == "time" ? "time" : name == "c" || name == "channel" ? "channel" : "space";
        if (axes[i].type == "space" && space++ >= 3) axes[i].type = "other";
    }
    return axes;
}

ZarrImage image_of_array(const ZarrNode& node, const std::string& path, const std::string& channel,
                         const Output& output) {
    ZarrImage image;
    ZarrArray array = zarr_array(node, path);
    const auto axes = axes_of_array(array);
    find_axes(axes, array, image);
    const Placing placing{std::vector<double>(axes.size(), 1), std::vector<double>(axes.size(), 0)};
    add_level(axes, placing, std::move(array), image);
    choose_moment(axes, placing, output, image);
    choose_channel(channel, json::object(), image);
    image.header.notes.push_back("an array that states neither spacing nor unit; 1 mm is taken");
    return image;
}

/// `only`: the path of one of its levels, which alone is taken; empty: all.
ZarrImage image_of_group(const ZarrStore& store, const json& attributes, const std::string& path,
                         const std::string& only, const std::string& channel, const Output& output) {
    const json multiscales = multiscales_of(attributes);
    const json& multiscale = multiscales[0];
    ZarrImage image;
    std::vector<Axis> axes;
    Placing first;
    for (const json& dataset : multiscale.at("datasets")) {
        const auto level = joined(path, dataset.at("path").get<std::string>());
        if (!only.empty() && level != only) continue;
        const ZarrNode node = zarr_node(store, level);
        if (!node.is_array) refuse(fmt::format("has no array at '{}', one of its levels", level));
        ZarrArray array = zarr_array(node, level);
        if (image.levels.empty()) {
            axes = axes_of(multiscale, array.shape.size());
            find_axes(axes, array, image);
        }
        Placing placing{std::vector<double>(axes.size(), 1), std::vector<double>(axes.size(), 0)};
        add_transforms(dataset.value("coordinateTransformations", json::array()), placing);
        add_transforms(multiscale.value("coordinateTransformations", json::array()), placing);
        if (image.levels.empty()) first = placing;
        if (array.shape.size() != axes.size()) refuse(fmt::format("has a level '{}' of other axes", level));
        add_level(axes, placing, std::move(array), image);
    }
    if (image.levels.empty()) refuse("states no levels");
    take_own_attributes(attributes, image);
    choose_moment(axes, first, output, image);
    choose_channel(channel, attributes, image);
    for (const int axis : image.space)
        if (axis >= 0 && !millimetres(axes[std::size_t(axis)].unit)) {
            image.header.notes.push_back(
                fmt::format("states its axis '{}' in '{}', which is no unit of length that is known; mm are taken",
                            axes[std::size_t(axis)].name, axes[std::size_t(axis)].unit));
            break;
        }
    if (multiscales.size() > 1)
        image.header.notes.push_back(
            fmt::format("holds {} descriptions of levels; the first is shown", multiscales.size()));
    return image;
}

bool has_image(const ZarrNode& node) { return !multiscales_of(node.attributes).is_null(); }

/// Paths of images in a group, or of arrays where it has no image: its own, and those a folder or two below.
void collect(const ZarrStore& store, const std::string& path, int depth, std::vector<std::string>& images,
             std::vector<std::string>& arrays) {
    constexpr std::size_t most = 1000;
    for (const std::string& name : store.names(path)) {
        if (images.size() + arrays.size() >= most) return;
        const std::string below = joined(path, name);
        if (name == "labels" || name == "OME" || name.find('.') != name.npos) continue;
        const ZarrNode node = zarr_node(store, below);
        if (node.is_array)
            arrays.push_back(below);
        else if (has_image(node))
            images.push_back(below);
        else if (node.version > 0 && depth > 0)
            collect(store, below, depth - 1, images, arrays);
    }
}

std::string list_of(const std::vector<std::string>& paths) {
    const std::size_t shown = std::min<std::size_t>(paths.size(), 8);
    return fmt::format("{}{}", fmt::join(paths.begin(), paths.begin() + std::ptrdiff_t(shown), ", "),
                       shown < paths.size() ? ", ..." : "");
}

/// What a group without levels of its own shows, and a note of what else it holds.
std::string chosen_below(const ZarrStore& store, const std::string& path, std::vector<std::string>& notes) {
    std::vector<std::string> images, arrays;
    collect(store, path, 2, images, arrays);
    if (images.empty() && arrays.empty()) refuse("holds neither an image nor an array");
    if (images.empty() && arrays.size() > 1)
        refuse(fmt::format("holds {} arrays; name one as STORE#PATH: {}", arrays.size(), list_of(arrays)));
    if (images.size() > 1)
        notes.push_back(fmt::format("holds {} images; the first is shown (STORE#PATH is another: {})", images.size(),
                                    list_of(images)));
    return images.empty() ? arrays[0] : images[0];
}

void tell_labels(const ZarrStore& store, const std::string& path, std::vector<std::string>& notes) {
    std::vector<std::string> labels;
    for (const std::string& name : store.names(joined(path, "labels")))
        if (has_image(zarr_node(store, joined(path, "labels/" + name))))
            labels.push_back(joined(path, "labels/" + name));
    if (!labels.empty())
        notes.push_back(fmt::format("has labels beside it (--labels STORE#PATH shows them): {}", list_of(labels)));
}

ZarrImage image_at(const ZarrStore& store, std::string path, const std::string& channel, const Output& output) {
    ZarrNode node = zarr_node(store, path);
    std::vector<std::string> notes;
    if (node.version == 0)
        refuse(path.empty() ? "holds no Zarr metadata" : fmt::format("holds no Zarr metadata at '{}'", path));
    if (!node.is_array && !has_image(node)) {
        path = chosen_below(store, path, notes);
        node = zarr_node(store, path);
    }
    ZarrImage image;
    if (node.is_array) {
        const auto slash = path.rfind('/');
        const std::string group = slash == path.npos ? "" : path.substr(0, slash);
        const ZarrNode around = path.empty() ? ZarrNode{false, 0, {}, json::object()} : zarr_node(store, group);
        bool is_level = false;
        if (const json multiscales = multiscales_of(around.attributes); !multiscales.is_null())
            for (const json& dataset : multiscales[0].at("datasets"))
                is_level = is_level || joined(group, dataset.at("path").get<std::string>()) == path;
        image = is_level ? image_of_group(store, around.attributes, group, path, channel, output)
                         : image_of_array(node, path, channel, output);
    } else {
        image = image_of_group(store, node.attributes, path, "", channel, output);
        tell_labels(store, path, notes);
    }
    notes.insert(notes.end(), image.header.notes.begin(), image.header.notes.end());
    image.header.notes = notes;
    if (!path.empty()) image.header.key_values["path"] = path;
    return image;
}

}  // namespace

ZarrImage open_zarr_image(const ZarrStore& store, const std::string& part, const Output& output) {
    const auto at = std::min(part.find('@'), part.size());
    std::string path = part.substr(0, at);
    while (path.starts_with('/')) path.erase(0, 1);
    while (path.ends_with('/')) path.pop_back();
    try {
        ZarrImage image = image_at(store, path, part.substr(std::min(at + 1, part.size())), output);
        Volume& header = image.header;
        const auto n = dimensions_of(image, image.levels[0]);
        header.dimensions = {int(n[0]), int(n[1]), int(n[2])};
        header.type = image.levels[0].type;
        header.geometry = image.geometries[0];
        header.format = "OME-Zarr";
        if (image.space[2] < 0) header.notes.push_back("a picture of two dimensions, taken as one slice");
        return image;
    } catch (const json::exception&) {
        refuse("has metadata of which a member is missing, or is none that it may be");
    }
}

}  // namespace chiaro::decode
