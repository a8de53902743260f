// What readers of transfer functions share.
#pragma once
#include <chiaro/transfer_file.h>

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace pugi {
class xml_document;
}

namespace chiaro {

inline constexpr std::size_t max_transfer_points = 65536, max_transfer_bytes = 16 << 20;
inline constexpr int max_transfer_depth = 64;

/// A text before its format is known, parsed once as what it begins like.
struct TransferText {
    const std::string& text;
    std::string name, ending, choice;          ///< the file; its name in small letters; the function asked for
    std::shared_ptr<nlohmann::json> json;      ///< with commas before a closing bracket forgiven, or null
    std::shared_ptr<pugi::xml_document> xml;   ///< or null
    std::string trouble = "is none of those";  ///< why it is neither

    /// Throws Error{input}: "NAME: what".
    [[noreturn]] void fail(const std::string& what) const;
    bool ends_with(const char* end) const { return ending.ends_with(end); }
    /// Whether it is JSON, or an object within a JSON array, that has one of these keys.
    bool has_key(std::initializer_list<const char*> keys) const;
    /// The name of the outermost XML element, or nothing.
    std::string root() const;
};

/// What a reader found, before it is checked and stretched.
struct FoundFunction {
    TransferFunction function;
    bool relative = false;  ///< values are shares: 0 the smallest value of the data, 1 the largest
    std::vector<std::string> functions, notes;
};

struct TransferReader {
    FormatInfo info;
    bool (*accepts)(const TransferText&);
    FoundFunction (*read)(const TransferText&, const Statistics&);
};

FoundFunction read_paraview(const TransferText& text, const Statistics& data);
FoundFunction read_slicer_json(const TransferText& text, const Statistics& data);
FoundFunction read_slicer_lines(const TransferText& text, const Statistics& data);
FoundFunction read_inviwo(const TransferText& text, const Statistics& data);
FoundFunction read_voreen(const TransferText& text, const Statistics& data);
FoundFunction read_own(const TransferText& text, const Statistics& data);

/// Which of several functions is meant, by its name or its number from 1 on; the first where none was asked for.
/// Throws Error{input} with "did you mean".
std::size_t chosen_function(const TransferText& text, const std::vector<std::string>& names);

/// A word of a file for a message: short, and without anything a terminal would obey.
std::string printable(const std::string& word);

/// A whole number or decimal from beginning to end, finite. Independent of the locale. Nothing for anything else.
bool parse_number(std::string_view word, double& number);

/// `number` if it lies in [low, high] or misses it by a rounding (1e-6), clamped; else fails naming `what`.
double in_range(const TransferText& text, const std::string& what, double number, double low, double high);

/// A position on the value axis: beyond 1e300 differences overflow.
double position(const TransferText& text, const std::string& what, double number);

}  // namespace chiaro
