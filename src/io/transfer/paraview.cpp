// ParaView's colour maps: JSON, one object or an array of them. RGBPoints holds value, red, green, blue; Points holds
// value, opacity, midpoint, sharpness; ColorSpace says in which space colours are mixed. Categories have IndexedColors
// and Annotations (value, label, value, label, ...). A map from 0 to 1 or -1 to 1 is one that ParaView ships or saves
// for any data, and is stretched; others are in data units, as are those that we wrote.
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "io/transfer/color_space.h"
#include "io/transfer/curve.h"
#include "io/transfer/json_node.h"
#include "io/transfer/reader.h"

namespace chiaro {
namespace {

/// The numbers of a list that come N at a time.
std::vector<double> numbers_by(const JsonNode& list, std::size_t n, const char* what) {
    if (!list.json.is_array()) list.fail_type("an array of numbers");
    const std::size_t count = list.json.size();
    if (count == 0 || count % n != 0) list.fail(fmt::format("has {} numbers: must have {} {}", count, n, what));
    if (count / n > max_transfer_points)
        list.fail(fmt::format("has {} points: must have 1..{}", count / n, max_transfer_points));
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(list.at(i).number());
    return numbers;
}

struct Space {
    ColorSpace space;
    bool approximate;  ///< another space stands for it
};

Space color_space(const JsonNode& map) {
    const std::string name = map.has("ColorSpace") ? map.at("ColorSpace").text() : "RGB";
    if (name == "RGB" || name == "Linear" || name == "sRGB") return {ColorSpace::rgb, false};
    if (name == "HSV") {
        const bool wrap = map.has("HSVWrap") && map.at("HSVWrap").flag();
        return {wrap ? ColorSpace::hsv_wrapped : ColorSpace::hsv, false};
    }
    if (name == "Wrapped") return {ColorSpace::hsv_wrapped, false};
    if (name == "Lab" || name == "CIELAB") return {ColorSpace::lab, false};
    if (name == "Diverging") return {ColorSpace::diverging, false};
    if (name == "Step") return {ColorSpace::step, false};
    if (name == "Lab/CIEDE2000" || name == "LabCIEDE2000" || name == "ProLab" || name == "Prolab")
        return {ColorSpace::lab, true};
    const std::vector<std::string> names{"RGB",       "HSV",  "Wrapped",       "Lab",   "CIELAB",
                                         "Diverging", "Step", "Lab/CIEDE2000", "Prolab"};
    const std::string hint = did_you_mean(name, names);
    map.at("ColorSpace")
        .fail(fmt::format("is '{}': must be one of {}{}", printable(name), fmt::join(names, ", "), hint));
}

ColorCurve colors_of(const TransferText& text, const JsonNode& map, ColorSpace space) {
    const JsonNode list = map.at("RGBPoints");
    const std::vector<double> numbers = numbers_by(list, 4, "for each point: value, red, green and blue");
    ColorCurve nodes;
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
        const auto at = [&](std::size_t k) { return fmt::format("{}[{}]", list.path, i + k); };
        nodes.push_back({position(text, at(0), numbers[i]), {}});
        for (std::size_t c = 0; c < 3; ++c) nodes.back().y[c] = in_range(text, at(c + 1), numbers[i + c + 1], 0, 1);
    }
    std::stable_sort(nodes.begin(), nodes.end(), [](auto& a, auto& b) { return a.x < b.x; });
    ColorCurve curve{nodes[0]};
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        const Rgb from = nodes[i - 1].y, to = nodes[i].y;
        const double before = nodes[i - 1].x, x = nodes[i].x;
        if (x == before) {
            curve.push_back(nodes[i]);
        } else if (space == ColorSpace::step) {  // a node's own value keeps its colour: labels lie on them
            curve.insert(curve.end(), {{std::nextafter(before, x), to}, {x, to}});
        } else {
            append_bent<3>(curve, nodes[i], {}, [&](double s) { return mixed(space, from, to, s); });
        }
        if (curve.size() > max_transfer_points)
            list.fail(fmt::format("needs more than {} points", max_transfer_points));
    }
    return curve;
}

OpacityCurve opacities_of(const TransferText& text, const JsonNode& map) {
    const JsonNode list = map.at("Points");
    const std::vector<double> numbers = numbers_by(list, 4, "for each point: value, opacity, midpoint and sharpness");
    struct Entry {
        CurveNode<1> node;
        Bend bend;
    };
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
        const auto at = [&](std::size_t k) { return fmt::format("{}[{}]", list.path, i + k); };
        const auto share = [&](std::size_t k) { return in_range(text, at(k), numbers[i + k], 0, 1); };
        entries.push_back({{position(text, at(0), numbers[i]), {share(1)}}, {share(2), share(3)}});
    }
    std::stable_sort(entries.begin(), entries.end(), [](auto& a, auto& b) { return a.node.x < b.node.x; });
    OpacityCurve curve{entries[0].node};
    for (std::size_t i = 1; i < entries.size(); ++i) {
        if (entries[i].node.x == entries[i - 1].node.x)
            curve.push_back(entries[i].node);
        else
            append_linear(curve, entries[i].node, entries[i - 1].bend);
        if (curve.size() > max_transfer_points)
            list.fail(fmt::format("needs more than {} points", max_transfer_points));
    }
    return curve;
}

// ---- categories

struct Category {
    double value, opacity;
    Rgb rgb;
};

/// The values that the annotations name; without them category i stands for the value i.
void place_categories(const JsonNode& map, std::vector<Category>& categories, FoundFunction& found) {
    bool placed = false;
    if (map.has("Annotations")) {
        const JsonNode list = map.at("Annotations");
        if (!list.json.is_array() || list.json.size() % 2 != 0) list.fail("must be an array of values and labels");
        placed = list.json.size() / 2 >= categories.size();
        for (std::size_t i = 0; placed && i < categories.size(); ++i)
            placed = parse_number(list.at(2 * i).text(), categories[i].value) && std::abs(categories[i].value) <= 1e300;
    }
    if (placed) return;
    for (std::size_t i = 0; i < categories.size(); ++i) categories[i].value = double(i);
    found.notes.push_back("its categories have no values: the first stands for 0, the next for 1, and so on");
}

std::vector<Category> categories_of(const TransferText& text, const JsonNode& map, FoundFunction& found) {
    const JsonNode list = map.at("IndexedColors");
    const std::vector<double> numbers = numbers_by(list, 3, "for each category: red, green and blue");
    std::vector<Category> categories(numbers.size() / 3);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        categories[i / 3].rgb[i % 3] = in_range(text, fmt::format("{}[{}]", list.path, i), numbers[i], 0, 1);
    place_categories(map, categories, found);
    std::stable_sort(categories.begin(), categories.end(), [](auto& a, auto& b) { return a.value < b.value; });
    const auto same = [](auto& a, auto& b) { return a.value == b.value; };
    categories.erase(std::unique(categories.begin(), categories.end(), same), categories.end());
    for (Category& c : categories) c.opacity = &c == categories.data() && categories.size() > 1 ? 0 : 0.25;
    found.notes.push_back(
        "its categories have no opacity: 0 for the lowest value, a quarter a voxel size for the rest");
    return categories;
}

/// Each category reaches half way to its neighbours.
std::vector<ControlPoint> boxes(const std::vector<Category>& categories) {
    std::vector<ControlPoint> points;
    for (std::size_t i = 0; i < categories.size(); ++i) {
        const Category& c = categories[i];
        const auto half = [&](std::size_t a, std::size_t b) {
            return categories.size() > 1 ? (categories[b].value - categories[a].value) / 2 : 0.5;
        };
        const std::size_t last = categories.size() - 1;
        const double low = i == 0 ? c.value - half(0, std::min<std::size_t>(1, last)) : points.back().value;
        const double high = c.value + (i == last ? half(last - (last > 0), last) : half(i, i + 1));
        points.push_back({low, c.rgb, c.opacity});
        points.push_back({high, c.rgb, c.opacity});
    }
    return points;
}

// ---- several maps

bool is_map(const Json& json) {
    return json.is_object() && (json.contains("RGBPoints") || json.contains("IndexedColors"));
}

JsonNode chosen_map(const TransferText& text, const JsonNode& root, FoundFunction& found) {
    if (!root.json.is_array()) return root;
    std::vector<std::size_t> maps;
    for (std::size_t i = 0; i < root.json.size(); ++i)
        if (is_map(root.json[i])) maps.push_back(i);
    if (maps.empty()) root.fail("holds no colour map: none of its entries has 'RGBPoints' or 'IndexedColors'");
    for (std::size_t i = 0; i < maps.size(); ++i) {
        const JsonNode map = root.at(maps[i]);
        found.functions.push_back(map.has("Name") ? map.at("Name").text() : std::to_string(i + 1));
    }
    const std::size_t chosen = chosen_function(text, found.functions);
    if (maps.size() > 1 && text.choice.empty()) {
        constexpr std::size_t told = 3;
        std::string names;
        for (std::size_t i = 1; i < maps.size() && i <= told; ++i)
            names += (i > 1 ? ", " : "") + printable(found.functions[i]);
        found.notes.push_back(fmt::format("holds {} colour maps: took '{}'; FILE#NAME or FILE#2 takes another ({}{})",
                                          maps.size(), printable(found.functions[0]), names,
                                          maps.size() > told + 1 ? ", ..." : ""));
    }
    return root.at(maps[chosen]);
}

// ---- values

/// What we add to a map so that reading it gives the same function.
bool read_own_key(const JsonNode& map, TransferFunction& tf) {
    if (!map.has("Chiaro")) return false;
    const JsonNode own = map.at("Chiaro");
    own.require_keys({"opacity_unit_distance", "opacity_unit_mm"});
    for (const char* key : {"opacity_unit_distance", "opacity_unit_mm"}) {
        if (!own.has(key)) continue;
        tf.opacity_unit = own.at(key).number();
        tf.opacity_unit_is_mm = std::string(key) == "opacity_unit_mm";
        if (!(tf.opacity_unit > 0)) own.at(key).fail("is " + to_text(tf.opacity_unit) + ": must be greater than 0");
    }
    return true;
}

bool is_for_any_data(const ColorCurve& color) {
    const double low = color.front().x, high = color.back().x;
    return high == 1 && (low == 0 || low == -1);
}

template <std::size_t N>
void normalise(Curve<N>& curve) {
    const double low = curve.front().x, high = curve.back().x;
    for (auto& node : curve) node.x = high > low ? (node.x - low) / (high - low) : 0;
}

void note_what_is_lost(const JsonNode& map, FoundFunction& found) {
    if (map.has("NanColor")) found.notes.push_back("its colour for values that are no numbers is not kept");
    for (const char* key : {"UseBelowRangeColor", "UseAboveRangeColor"})
        if (map.has(key) && map.at(key).flag())
            found.notes.push_back(std::string(key).substr(3) + " is not kept: values outside have the nearest colour");
    if (map.has("UseLogScale") && map.at("UseLogScale").flag())
        found.notes.push_back("its logarithmic scale is not kept");
}

void read_points(const TransferText& text, const JsonNode& map, FoundFunction& found) {
    const auto [space, approximate] = color_space(map);
    ColorCurve color = colors_of(text, map, space);
    if (approximate) found.notes.push_back("its colour space is taken as Lab, which is near but not the same");
    const bool own = read_own_key(map, found.function);
    found.relative = !own && is_for_any_data(color);
    if (found.relative) normalise(color);
    OpacityCurve opacity;
    if (map.has("Points")) {
        opacity = opacities_of(text, map);
        if (found.relative) normalise(opacity);
    } else {
        opacity = color_map_opacity(color.front().x, color.back().x);
        found.notes.push_back("it has no opacity: 0 over the lowest tenth, then rising to a quarter a voxel size");
    }
    found.function.points = united(color, opacity);
    if (found.relative)
        found.notes.push_back("it is a map for any data (0 to 1 or -1 to 1), stretched over the data's range");
}

}  // namespace

FoundFunction read_paraview(const TransferText& text, const Statistics&) {
    if (!text.json) text.fail(text.trouble);
    FoundFunction found;
    const JsonNode map = chosen_map(text, {*text.json, text.name, ""}, found);
    map.require_object();
    if (!is_map(map.json)) {
        std::string hint;
        for (const auto& [key, value] : map.json.items())
            if (hint.empty()) hint = did_you_mean(key, std::vector<std::string>{"RGBPoints", "IndexedColors"});
        map.fail("lacks 'RGBPoints' and 'IndexedColors'" + hint);
    }
    const bool indexed = !map.has("RGBPoints") ||
                         (map.has("IndexedColors") && map.has("IndexedLookup") && map.at("IndexedLookup").flag());
    if (indexed)
        found.function.points = boxes(categories_of(text, map, found));
    else
        read_points(text, map, found);
    if (map.has("Name")) found.function.name = map.at("Name").text();
    if (map.has("Chiaro") && found.function.name == "Chiaro") found.function.name.clear();  // ParaView wants a name
    note_what_is_lost(map, found);
    return found;
}

}  // namespace chiaro
