// Transfer functions in files: ours, and those of other programs.
#pragma once
#include <chiaro/export.h>
#include <chiaro/io.h>
#include <chiaro/transfer_function.h>

#include <string>
#include <vector>

namespace chiaro {

/// A transfer function as a file tells it, and what a user should know of how it was taken.
struct TransferFile {
    TransferFunction function;
    std::string format;                  ///< a name of list_transfer_formats, or "preset"
    std::vector<std::string> functions;  ///< names of all that the file holds; empty where a file holds one
    bool stretched = false;              ///< its values are shares of a range, stretched over the data's
    std::vector<std::string> notes;      ///< what was assumed or is not kept, a sentence each
};

/// Formats that are read, in the order in which they are tried. `note` says which are also written.
CHIARO_EXPORT std::vector<FormatInfo> list_transfer_formats();

/// Reads a text of any listed format, recognised by the ending of its name and its content, or of `format` alone where
/// one is named. `name` stands in messages, and `name#FUNCTION` (or #1, #2, ...) picks one of several functions in the
/// text; without it the first is taken. Values that are shares of a range are stretched from data.min to data.max.
/// Curved colour spaces and curves are sampled so that no component is off by more than `transfer_sampling_error`.
/// Whatever the text holds, this returns a valid function of at most 65536 points or throws Error{input} with one
/// sentence that names the place (Error{usage} for a format that there is not). Time and memory grow with its length.
CHIARO_EXPORT TransferFile parse_transfer_file(const std::string& text, const std::string& name, const Statistics& data,
                                               const std::string& format = "");
inline constexpr double transfer_sampling_error = 0.001;

/// Reads FILE or FILE#FUNCTION of at most 16 MiB; a name that is no file is a preset or colour map.
/// Throws as parse_transfer_file and preset.
CHIARO_EXPORT TransferFile read_transfer_file(const std::string& name, const Statistics& data);

/// FILE#FUNCTION in two: the file, and the name behind the last # (empty where there is none, or the whole is a file).
struct TransferName {
    std::string file, function;
};
CHIARO_EXPORT TransferName split_transfer_name(const std::string& name);

/// A colour map of ParaView (JSON) with opacities. The unit of opacity, which ParaView's maps lack, is kept in a key
/// of ours, so that reading gives the same function; linear colours become sRGB, sampled as above.
CHIARO_EXPORT std::string to_paraview_json(const TransferFunction& tf);

}  // namespace chiaro
