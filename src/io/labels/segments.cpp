// Segmentations of 3D Slicer (.seg.nrrd): key/values Segment<N>_Name, _Color (three numbers in [0, 1]), _LabelValue and
// _Layer for each segment; voxels hold a value for each layer.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text.h"
#include "io/labels/table.h"

namespace chiaro {
namespace {

class Reader {
public:
    Reader(const std::map<std::string, std::string>& all, const std::string& name) : all_(all), name_(name) {}

    bool has(std::size_t segment) const {
        return find(segment, "LabelValue") || find(segment, "ID") || find(segment, "Name");
    }
    Segment segment(std::size_t i) const {
        Segment segment{.label = {.value = 1, .name = fmt::format("segment {}", i + 1)}};
        if (const auto* value = find(i, "LabelValue"); value && !parse_label_value(*value, segment.label.value))
            fail(i, "LabelValue", *value, "a whole number from 0 to 4294967295");
        std::uint32_t layer = 0;
        if (const auto* text = find(i, "Layer"); text && (!parse_label_value(*text, layer) || layer > 65535))
            fail(i, "Layer", *text, "a whole number from 0 to 65535");
        segment.layer = int(layer);
        if (const auto* text = find(i, "Name")) segment.label.name = *text;
        const auto* color = find(i, "Color");
        segment.label.rgb = color ? rgb(i, *color) : label_color(std::uint32_t(i + 1));
        return segment;
    }

private:
    const std::string* find(std::size_t segment, const char* key) const {
        const auto found = all_.find(fmt::format("Segment{}_{}", segment, key));
        return found == all_.end() ? nullptr : &found->second;
    }
    [[noreturn]] void fail(std::size_t segment, const char* key, const std::string& text, const char* wanted) const {
        throw Error(ErrorCode::input, fmt::format("{}: Segment{}_{} is '{}': must be {}", one_line(name_), segment, key,
                                                  one_line(text, 80), wanted));
    }
    Rgb rgb(std::size_t segment, const std::string& text) const {
        Rgb rgb{};
        const char* at = text.data();
        const char* const end = at + text.size();
        for (double& c : rgb) {
            while (at < end && *at == ' ') ++at;
            const auto [next, error] = std::from_chars(at, end, c);
            if (error != std::errc{} || !(c >= 0 && c <= 1)) fail(segment, "Color", text, "three numbers in [0, 1]");
            at = next;
        }
        return rgb;
    }

    const std::map<std::string, std::string>& all_;
    const std::string& name_;
};

}  // namespace

std::vector<Segment> segments_of(const std::map<std::string, std::string>& key_values, const std::string& name) {
    const Reader reader(key_values, name);
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < max_labels && reader.has(i); ++i) segments.push_back(reader.segment(i));
    return segments;
}

}  // namespace chiaro
