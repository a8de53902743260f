// What readers of label tables share.
#pragma once
#include <chiaro/labels.h>

#include <map>

namespace chiaro {

inline constexpr std::size_t max_table_bytes = 16 << 20;

struct LabelText {
    const std::string& text;
    std::string name, ending;  ///< the file; its name in small letters

    /// Throws Error{input}: "NAME: what".
    [[noreturn]] void fail(const std::string& what) const;
    bool ends_with(std::string_view end) const { return ending.ends_with(end); }
};

LabelTable read_own_labels(const LabelText& text);   ///< and the class lists of nnU-Net
LabelTable read_label_lines(const LabelText& text);  ///< ITK-SNAP, 3D Slicer, FreeSurfer
LabelTable total_segmentator();
/// Of the key/values of a .seg.nrrd.
struct Segment {
    Label label;
    int layer = 0;
};
std::vector<Segment> segments_of(const std::map<std::string, std::string>& key_values, const std::string& name);

/// A whole number from 0 to 2^32 - 1; false for anything else.
bool parse_label_value(std::string_view word, std::uint32_t& value);
/// Colours that are well apart from those of neighbouring values.
Rgb label_color(std::uint32_t value);

}  // namespace chiaro
