#include "decode/nrrd_header.h"

#include "decode/byte_source.h"
#include "decode/output.h"

#include <fmt/format.h>

#include <optional>

namespace chiaro::decode {
namespace {

constexpr std::size_t longest_header = 1 << 20;

std::string beginning_of(const std::filesystem::path& path) {
    constexpr std::size_t piece = 1 << 14;
    const auto source = open_plain(path);
    std::string text;
    const auto goes_on = [&] { return text.find("\n\n") == text.npos && text.find("\n\r\n") == text.npos; };
    for (std::size_t got = piece; got == piece && text.size() < longest_header && goes_on();) {
        const std::size_t before = text.size();
        text.resize(before + piece);
        got = source->read(std::as_writable_bytes(std::span(text).subspan(before)));
        text.resize(before + got);
    }
    return text;
}

/// Lines with their ends, of which NRRD allows \n and \r\n.
class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {}

    std::optional<std::string_view> next() {
        const auto end = text_.find('\n', at_);
        if (end == std::string_view::npos) {
            if (at_ >= text_.size()) return {};
            return cut(text_.size(), text_.size());
        }
        return cut(end, end + 1);
    }
    std::size_t position() const { return at_; }

private:
    std::string_view cut(std::size_t end, std::size_t next) {
        auto line = text_.substr(at_, end - at_);
        if (line.ends_with('\r')) line.remove_suffix(1);
        at_ = next;
        return line;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

std::string unescaped(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escape = text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\');
        result += !escape ? text[i] : text[++i] == 'n' ? '\n' : '\\';
    }
    return result;
}

/// One line: a comment, `key:=value`, or `field: description`.
void take_line(std::string_view line, NrrdHeader& header) {
    if (line.starts_with('#')) return;
    const auto colon = line.find(':');
    if (colon == std::string_view::npos)
        refuse(fmt::format("its NRRD header has the line '{}', which is no field", line.substr(0, 40)));
    const std::string value(line.substr(colon + 1));
    if (value.starts_with('='))
        header.key_values[unescaped(line.substr(0, colon))] = unescaped(std::string_view(value).substr(1));
    else if (const std::string name = lower(trimmed(line.substr(0, colon)));
             !header.fields.emplace(name, trimmed(value)).second)
        refuse(fmt::format("its NRRD header states '{}' twice", name));
}

/// Spellings that mean the same.
void unify_names(Fields& fields) {
    const std::pair<const char*, const char*> synonyms[] = {{"datafile", "data file"},
                                                            {"lineskip", "line skip"},
                                                            {"byteskip", "byte skip"},
                                                            {"centerings", "centers"},
                                                            {"sample units", "sampleunits"}};
    for (const auto& [other, name] : synonyms)
        if (auto node = fields.extract(other)) {
            node.key() = name;
            if (!fields.insert(std::move(node)).inserted)
                refuse(fmt::format("its NRRD header states '{}' twice", name));
        }
}

}  // namespace

NrrdHeader read_nrrd_header(const std::filesystem::path& path) {
    const std::string text = beginning_of(path);
    if (!text.starts_with("NRRD000")) refuse("is no NRRD file: it does not start with 'NRRD000'");
    NrrdHeader header;
    Lines lines(text);
    lines.next();
    bool in_list = false;
    for (auto line = lines.next(); line && !line->empty(); line = lines.next()) {
        if (in_list) {
            header.data_files.push_back(trimmed(*line));
            continue;
        }
        take_line(*line, header);
        unify_names(header.fields);
        in_list = value_or(header.fields, "data file").starts_with("LIST");
    }
    if (lines.position() == longest_header) refuse("has an NRRD header of more than 1 MiB");
    header.data_offset = lines.position();
    return header;
}

}  // namespace chiaro::decode
