#include "decode/tiff_layout.h"

#include "decode/output.h"
#include "decode/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

namespace chiaro::decode {
namespace {

std::optional<double> millimetres(std::string unit) {
    if (unit == "\\u00B5m" || unit == "\xc2\xb5m" || unit == "\xce\xbcm" || unit == "\xb5m") unit = "um";
    static const std::map<std::string, double> units = {
        {"m", 1000},          {"cm", 10},        {"mm", 1},           {"um", 1e-3},
        {"micron", 1e-3},     {"microns", 1e-3}, {"nm", 1e-6},        {"inch", 25.4},
        {"micrometer", 1e-3}, {"in", 25.4},      {"pm", 1e-9},        {"\xc3\x85", 1e-7},
        {"meter", 1000},      {"millimeter", 1}, {"nanometer", 1e-6}, {"centimeter", 10}};
    const auto found = units.find(unit);
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::optional<double> positive(const Fields& fields, const char* name) {
    if (!fields.contains(name)) return {};
    const double value = number(fields.at(name), name);
    return std::isfinite(value) && value != 0 ? std::optional(std::abs(value)) : std::nullopt;
}

std::int64_t count(const std::string& text, const char* name) {
    const auto value = integer(text, name);
    if (value < 1 || value > 1'000'000) refuse(fmt::format("its description states {} {}", value, name));
    return value;
}

/// Lines `name=value`. Pages run through channels, then slices, then times.
TiffLayout from_imagej(const std::string& text, std::int64_t pages) {
    Fields fields;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (const auto equals = line.find('='); equals != std::string::npos)
            fields[line.substr(0, equals)] = trimmed(line.substr(equals + 1));
    TiffLayout layout{.stated = true};
    const auto images = count(value_or(fields, "images", std::to_string(pages)), "images");
    layout.channels = count(value_or(fields, "channels", "1"), "channels");
    layout.times = count(value_or(fields, "frames", "1"), "frames");
    layout.slices = fields.contains("slices") ? count(fields.at("slices"), "slices")
                                              : std::max<std::int64_t>(1, images / (layout.channels * layout.times));
    if (!fields.contains("slices") && layout.channels == 1 && layout.slices == 1) {  // a stack told as frames
        layout.slices = images;
        layout.times = 1;
    }
    layout.slice_step = layout.channels;
    layout.time_step = layout.channels * layout.slices;
    if (const auto step = positive(fields, "finterval")) layout.seconds = *step;
    layout.unit_mm = millimetres(value_or(fields, "unit"));
    if (const auto z = positive(fields, "spacing"); z && layout.unit_mm) layout.z_spacing_mm = *z * *layout.unit_mm;
    if (const auto z = positive(fields, "spacing"); z && !layout.unit_mm) layout.z_spacing_mm = z;
    constexpr const char* straight_line = "0";
    if (value_or(fields, "cf") == straight_line && fields.contains("c0") && fields.contains("c1")) {
        layout.intercept = number(fields.at("c0"), "c0");
        layout.slope = number(fields.at("c1"), "c1");
    }
    return layout;
}

std::optional<double> physical_size(const pugi::xml_node& pixels, const std::string& axis) {
    const double size = pixels.attribute(("PhysicalSize" + axis).c_str()).as_double();
    const auto unit = millimetres(pixels.attribute(("PhysicalSize" + axis + "Unit").c_str()).as_string("um"));
    return size > 0 && std::isfinite(size) && unit ? std::optional(size * *unit) : std::nullopt;
}

/// Between moments; 0 where that is not told in a unit of time.
double seconds_of(const pugi::xml_node& pixels) {
    const double step = pixels.attribute("TimeIncrement").as_double();
    const std::string unit = pixels.attribute("TimeIncrementUnit").as_string("s");
    const double seconds = unit == "s" ? 1 : unit == "ms" ? 1e-3 : unit == "min" ? 60 : unit == "h" ? 3600 : 0;
    return step > 0 && std::isfinite(step) ? step * seconds : 0;
}

/// Names, and colours that are told: a signed 32-bit number of red, green, blue and alpha, of which white is the
/// default.
std::vector<ComponentInfo> channels_of(const pugi::xml_node& pixels) {
    std::vector<ComponentInfo> infos;
    for (const auto& channel : pixels.children("Channel")) {
        if (infos.size() == 64) break;
        ComponentInfo& info = infos.emplace_back(ComponentInfo{channel.attribute("Name").as_string(), {}});
        if (const auto stated = channel.attribute("Color")) {
            const auto color = std::uint32_t(stated.as_int(-1));
            const auto part = [&](int shift) { return (color >> shift & 255) / 255.0; };
            info.rgb = {part(24), part(16), part(8)};
        }
    }
    return infos;
}

/// Where TiffData names files: all planes that lie in them. Each names the first of a run of pages, in the order of the
/// dimensions.
std::vector<TiffPlane> planes_of(const pugi::xml_node& pixels, const TiffLayout& layout) {
    constexpr std::int64_t most = 4 * 65535;
    const std::int64_t images = layout.images();
    std::vector<TiffPlane> planes;
    if (layout.channels > most || layout.slices > most || layout.times > most || images > most) return {};
    for (const auto& data : pixels.children("TiffData")) {
        const std::string file = data.child("UUID").attribute("FileName").as_string();
        if (file.empty()) return {};
        const auto at = [&](const char* name) {
            return std::clamp<std::int64_t>(data.attribute(name).as_llong(), 0, most);
        };
        const std::int64_t first =
            at("FirstC") * layout.channel_step + at("FirstZ") * layout.slice_step + at("FirstT") * layout.time_step;
        const std::int64_t count = data.attribute("PlaneCount") ? at("PlaneCount") : 1;
        for (std::int64_t i = 0; i < count && first + i < images && std::int64_t(planes.size()) < images; ++i)
            planes.push_back({file, std::size_t(at("IFD") + i), std::size_t(first + i)});
    }
    return planes;
}

/// https://docs.openmicroscopy.org/ome-model/: Pixels with SizeZ, SizeC, SizeT, and the order of the pages.
TiffLayout from_ome(const std::string& text, int samples) {
    pugi::xml_document document;
    if (!document.load_buffer(text.data(), text.size(), pugi::parse_escapes)) return {};
    const auto ome = document.child("OME");
    const auto pixels = ome.child("Image").child("Pixels");
    if (!pixels) return {.metadata_file = ome.child("BinaryOnly").attribute("MetadataFile").as_string()};
    const auto size = [&](const char* name) { return count(pixels.attribute(name).as_string("1"), name); };
    TiffLayout layout{.stated = true, .channels = size("SizeC"), .slices = size("SizeZ"), .times = size("SizeT")};
    if (samples > 1 && layout.channels % samples == 0) layout.channels /= samples;
    layout.channel_infos = channels_of(pixels);
    std::int64_t step = 1;
    for (const char axis : std::string(pixels.attribute("DimensionOrder").as_string("XYZCT"))) {
        if (axis == 'Z') layout.slice_step = step, step *= layout.slices;
        if (axis == 'C') layout.channel_step = step, step *= layout.channels;
        if (axis == 'T') layout.time_step = step, step *= layout.times;
    }
    layout.planes = planes_of(pixels, layout);
    layout.seconds = seconds_of(pixels);
    layout.x_spacing_mm = physical_size(pixels, "X");
    layout.y_spacing_mm = physical_size(pixels, "Y");
    layout.z_spacing_mm = physical_size(pixels, "Z");
    return layout;
}

}  // namespace

TiffLayout layout_from(const std::string& description, std::int64_t pages, int samples) {
    if (description.starts_with("ImageJ=")) return from_imagej(description, pages);
    if (description.find("<OME") != std::string::npos) return from_ome(description, samples);
    return {};
}

std::vector<ComponentInfo> imagej_colors(const std::vector<std::uint32_t>& counts, const std::string& metadata) {
    constexpr std::size_t table_bytes = 3 * 256;
    if (counts.empty() || counts[0] < 12 || counts[0] > metadata.size()) return {};
    const bool little = metadata.starts_with("JIJI");
    if (!little && !metadata.starts_with("IJIJ")) return {};
    const auto number_at = [&](std::size_t at) {
        std::uint32_t number = 0;
        for (std::size_t i = 0; i < 4; ++i)
            number |= std::uint32_t(std::uint8_t(metadata[at + (little ? i : 3 - i)])) << (8 * i);
        return number;
    };
    constexpr std::uint32_t tables = 0x6c757473;  // "luts"
    std::vector<ComponentInfo> infos;
    std::size_t at = counts[0], item = 1;
    for (std::size_t kind = 4; kind + 8 <= counts[0]; kind += 8)
        for (std::uint32_t i = 0; i < number_at(kind + 4) && item < counts.size(); at += counts[item++], ++i) {
            if (counts[item] > metadata.size() - std::min(at, metadata.size())) return infos;
            if (number_at(kind) != tables || counts[item] != table_bytes) continue;
            const auto last = [&](std::size_t color) { return std::uint8_t(metadata[at + 256 * color + 255]) / 255.0; };
            infos.push_back({"", std::array{last(0), last(1), last(2)}});
        }
    return infos;
}

}  // namespace chiaro::decode
