// An element of an XML file with its line, for messages such as "a.itf: line 7 <rgba> x is 2: must be in [0, 1]".
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <string>

#include "io/transfer/reader.h"

namespace chiaro {

struct XmlNode {
    pugi::xml_node node;
    const TransferText& text;

    std::string place() const {
        const auto offset = std::clamp<std::ptrdiff_t>(node.offset_debug(), 0, std::ptrdiff_t(text.text.size()));
        const auto line = 1 + std::count(text.text.begin(), text.text.begin() + offset, '\n');
        return fmt::format("line {} <{}>", line, printable(node.name()));
    }
    [[noreturn]] void fail(const std::string& what) const { text.fail(place() + " " + what); }

    XmlNode child(const char* name) const {
        const pugi::xml_node found = node.child(name);
        if (!found) fail(fmt::format("lacks <{}>", name));
        return {found, text};
    }
    /// The first of these that there is, or an empty node.
    pugi::xml_node any_child(std::initializer_list<const char*> names) const {
        for (const char* name : names)
            if (const pugi::xml_node found = node.child(name)) return found;
        return {};
    }
    double number(const char* attribute) const {
        const pugi::xml_attribute found = node.attribute(attribute);
        if (!found) fail(fmt::format("lacks {}", attribute));
        double value = 0;
        if (!parse_number(found.value(), value))
            fail(fmt::format("{} is '{}': must be a number", attribute, printable(found.value())));
        return value;
    }
    // The place is looked up for the message alone: it takes counting lines from the beginning.
    double number_in(const char* attribute, double low, double high) const {
        const double value = number(attribute);
        return value >= low && value <= high ? value : in_range(text, place() + " " + attribute, value, low, high);
    }
    double position_at(const char* attribute) const {
        const double value = number(attribute);
        return std::abs(value) <= 1e300 ? value : position(text, place() + " " + attribute, value);
    }
};

/// The outermost element. Throws where the text is no XML or its root is none of these.
inline XmlNode xml_root(const TransferText& text, std::initializer_list<const char*> names) {
    if (!text.xml) text.fail(text.trouble.starts_with("is none") ? "is not XML" : text.trouble);
    const std::string root = text.root();
    if (std::none_of(names.begin(), names.end(), [&](auto name) { return root == name; }))
        text.fail(fmt::format("begins with <{}>: must be {}", printable(root), fmt::join(names, " or ")));
    return {text.xml->document_element(), text};
}

}  // namespace chiaro
