// Everything that a transfer function can be read from, in the order in which it is tried.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <pugixml.hpp>

#include "core/did_you_mean.h"
#include "core/file_contents.h"
#include "core/share.h"
#include "core/text.h"
#include "io/transfer/json_node.h"
#include "io/transfer/reader.h"
#include "io/xml_attributes.h"

namespace chiaro {
namespace {

namespace fs = std::filesystem;

const std::vector<TransferReader>& readers() {
    static const std::vector<TransferReader> all{
        {{"Slicer JSON", ".vp.json", "3D Slicer volume property"},
         [](auto& t) { return t.ends_with(".vp.json") || t.has_key({"volumeProperties"}); },
         read_slicer_json},
        {{"Slicer", ".vp", "3D Slicer volume property in lines"},
         [](auto& t) { return t.ends_with(".vp"); },
         read_slicer_lines},
        {{"Inviwo", ".itf", "relative to the data's range, or absolute"},
         [](auto& t) {
             const std::string root = t.root();
             return t.ends_with(".itf") || root == "InviwoWorkspace" || root == "InviwoTreeData" ||
                    root == "TransferFunction";
         },
         read_inviwo},
        {{"Voreen", ".tfi", "thresholds, domain and gamma"},
         [](auto& t) { return t.ends_with(".tfi") || t.root() == "VoreenData"; },
         read_voreen},
        {{"ParaView", ".json", "colour maps, one or several; also written (.paraview.json)"},
         [](auto& t) {
             return t.ends_with(".paraview.json") || (t.json && t.json->is_array()) ||
                    t.has_key({"RGBPoints", "IndexedColors", "ColorSpace"});
         },
         read_paraview},
        {{"Chiaro", ".json", "ours, in points or {\"preset\": NAME}; also written"},
         [](auto& t) { return t.ends_with(".json") || t.json; },
         read_own},
    };
    return all;
}

/// Replaces each comma with nothing but blanks between it and a closing bracket by a blank: places stay as they are.
std::string without_trailing_commas(std::string text) {
    std::size_t comma = text.npos;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            i += c == '\\';
            quoted = c != '"';
        } else if ((c == ']' || c == '}') && comma != text.npos) {
            text[comma] = ' ';
            comma = text.npos;
        } else if (!std::strchr(" \t\r\n", c) || c == '\0') {
            comma = c == ',' ? i : text.npos;
            quoted = c == '"';
        }
    }
    return text;
}

void parse_json(TransferText& text) {
    if (is_deeper_than(max_transfer_depth, text.text))
        text.fail(fmt::format("is nested more than {} deep", max_transfer_depth));
    try {
        text.json = std::make_shared<Json>(Json::parse(without_trailing_commas(text.text)));
        if (const auto twice = json_contradiction(text.text); !twice.empty()) text.fail(twice);
    } catch (const Json::exception& error) {
        text.trouble = json_trouble(error);
    }
}

void parse_xml(TransferText& text) {
    auto document = std::make_shared<pugi::xml_document>();
    const auto result = document->load_buffer(text.text.data(), text.text.size(),
                                              pugi::parse_default | pugi::parse_declaration, pugi::encoding_utf8);
    if (result) {
        if (const auto twice = attribute_stated_twice(*document); !twice.empty())
            text.fail("states " + twice + " twice");
        text.xml = std::move(document);
        return;
    }
    const auto end = text.text.begin() + std::clamp<std::ptrdiff_t>(result.offset, 0, std::ptrdiff_t(text.text.size()));
    text.trouble =
        fmt::format("is not XML: line {}: {}", 1 + std::count(text.text.begin(), end, '\n'), result.description());
}

TransferText examine(const std::string& text, const std::string& name) {
    auto [file, function] = split_transfer_name(name);
    TransferText examined{.text = text, .name = file, .ending = file, .choice = function, .json = {}, .xml = {}};
    for (char& c : examined.ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (text.size() > max_transfer_bytes) examined.fail("is larger than 16 MiB, which no transfer function needs");
    const std::size_t bom = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n", bom), text.size());
    if (first == text.size())
        examined.trouble = "is empty";
    else if (text[first] == '<')
        parse_xml(examined);
    else if (text[first] == '{' || text[first] == '[' || examined.ends_with(".json"))
        parse_json(examined);
    return examined;
}

const TransferReader& reader_for(const TransferText& text, const std::string& format) {
    std::vector<std::string> names;
    for (const TransferReader& reader : readers()) {
        if (format.empty() ? reader.accepts(text) : reader.info.name == format) return reader;
        names.push_back(reader.info.name);
    }
    if (!format.empty())
        throw Error(ErrorCode::usage,
                    fmt::format("there is no transfer-function format '{}': must be one of {}{}", printable(format),
                                fmt::join(names, ", "), did_you_mean(format, names)));
    if (text.trouble.starts_with("is not") || text.trouble == "is empty") text.fail(text.trouble);
    text.fail(fmt::format("is none of the transfer-function formats {}", fmt::join(names, ", ")));
}

void stretch(TransferFunction& tf, const Statistics& data) {
    for (ControlPoint& point : tf.points)
        point.value = data.max > data.min ? at_share(data.min, data.max, point.value) : data.min + point.value;
}

bool exists(const std::string& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
}

}  // namespace

void TransferText::fail(const std::string& what) const { throw Error(ErrorCode::input, name + ": " + one_line(what)); }

bool TransferText::has_key(std::initializer_list<const char*> keys) const {
    return json && json->is_object() &&
           std::any_of(keys.begin(), keys.end(), [&](auto key) { return json->contains(key); });
}

std::string TransferText::root() const { return xml ? xml->document_element().name() : ""; }

std::size_t chosen_function(const TransferText& text, const std::vector<std::string>& names) {
    if (text.choice.empty()) return 0;
    const auto named = std::find(names.begin(), names.end(), text.choice);
    if (named != names.end()) return std::size_t(named - names.begin());
    double number = 0;
    if (parse_number(text.choice, number)) {
        if (number >= 1 && number <= double(names.size()) && number == std::floor(number))
            return std::size_t(number) - 1;
        text.fail(fmt::format("has no function number {}: must be 1 to {}", printable(text.choice), names.size()));
    }
    const std::string hint = did_you_mean(text.choice, names);
    text.fail(fmt::format("has no function '{}'{}", printable(text.choice),
                          hint.empty() ? fmt::format(": must be 1 to {}, or a name", names.size()) : printable(hint)));
}

std::string printable(const std::string& word) { return one_line(word, 80); }

bool parse_number(std::string_view word, double& number) {
    word.remove_prefix(word.starts_with('+') && !word.starts_with("+-") ? 1 : 0);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc{} && end == word.data() + word.size() && std::isfinite(number);
}

double in_range(const TransferText& text, const std::string& what, double number, double low, double high) {
    constexpr double rounding = 1e-6;
    if (!(number >= low - rounding && number <= high + rounding))
        text.fail(fmt::format("{} is {}: must be in [{}, {}]", what, number, low, high));
    return std::clamp(number, low, high);
}

double position(const TransferText& text, const std::string& what, double number) {
    if (!(std::abs(number) <= 1e300)) text.fail(fmt::format("{} is {}: must be in [-1e300, 1e300]", what, number));
    return number;
}

std::vector<FormatInfo> list_transfer_formats() {
    std::vector<FormatInfo> formats;
    for (const TransferReader& reader : readers()) formats.push_back(reader.info);
    return formats;
}

TransferFile parse_transfer_file(const std::string& text, const std::string& name, const Statistics& data,
                                 const std::string& format) {
    const TransferText examined = examine(text, name);
    const TransferReader& reader = reader_for(examined, format);
    FoundFunction found = reader.read(examined, data);
    TransferFile file{std::move(found.function), reader.info.name, std::move(found.functions), found.relative,
                      std::move(found.notes)};
    if (!examined.choice.empty() && file.functions.empty())
        examined.fail(fmt::format("holds one function: there is no '{}' to choose", printable(examined.choice)));
    if (file.function.points.size() > max_transfer_points)
        examined.fail(fmt::format("needs more than {} points", max_transfer_points));
    if (found.relative) stretch(file.function, data);
    try {
        validate(file.function);
    } catch (const Error& error) {
        throw Error(error.code(), examined.name + ": " + error.what());
    }
    return file;
}

TransferFile read_transfer_file(const std::string& name, const Statistics& data) {
    const std::string file = split_transfer_name(name).file;
    if (exists(file)) return parse_transfer_file(file_text(file, max_transfer_bytes), name, data);
    if (name.find_first_of("/.") != name.npos)
        throw Error(ErrorCode::input, "cannot read '" + file + "': no such file" + did_you_mean_file(file));
    return {preset(name, data), "preset", {}, false, {}};
}

TransferFunction load_transfer_function(const std::string& file_or_preset, const Statistics& data) {
    return read_transfer_file(file_or_preset, data).function;
}

TransferName split_transfer_name(const std::string& name) {
    const std::size_t hash = name.rfind('#');
    if (hash == name.npos || exists(name)) return {name, ""};
    return {name.substr(0, hash), name.substr(hash + 1)};
}

}  // namespace chiaro
