// Our own label tables, and lists of classes as nnU-Net and TotalSegmentator write them: {"labels": {NAME: VALUE}}, or
// {VALUE: NAME}.
#include <fmt/format.h>

#include "io/labels/table.h"
#include "io/transfer/json_node.h"

namespace chiaro {
namespace {

std::uint32_t value_of(const JsonNode& node) {
    const double number = node.number();
    if (!(number >= 0 && number <= 4294967295.0 && number == double(std::uint32_t(number))))
        node.fail(fmt::format("is {}: must be a whole number from 0 to 4294967295", number));
    return std::uint32_t(number);
}

double share_of(const JsonNode& node) {
    const double number = node.number();
    if (!(number >= 0 && number <= 1)) node.fail(fmt::format("is {}: must be in [0, 1]", number));
    return number;
}

Label own_label(const JsonNode& node) {
    node.require_keys({"value", "name", "rgb", "tint", "opacity", "show", "transfer_function"});
    Label label{.value = value_of(node.at("value"))};
    if (node.has("name")) label.name = node.at("name").text();
    if (node.has("tint")) label.tint = share_of(node.at("tint"));
    if (node.has("opacity")) label.opacity = share_of(node.at("opacity"));
    if (node.has("show")) label.show = node.at("show").flag();
    if (node.has("transfer_function")) {
        const JsonNode tf = node.at("transfer_function");
        label.transfer = parse_transfer_function(tf.json.dump(), tf.origin + ": " + tf.path);
        if (!node.has("tint")) label.tint = 0;  // its colours are the function's
    }
    if (!node.has("rgb")) {
        label.rgb = label_color(label.value);
        if (label.value == 0 && !node.has("tint")) label.tint = 0;
        return label;
    }
    const JsonNode rgb = node.at("rgb");
    if (!rgb.json.is_array() || rgb.json.size() != 3) rgb.fail("must be three numbers");
    for (std::size_t c = 0; c < 3; ++c) label.rgb[c] = share_of(rgb.at(c));
    return label;
}

Label class_of(const JsonNode& labels, const std::string& key) {
    const JsonNode node{labels.json.at(key), labels.origin, labels.path + "." + one_line(key, 80)};
    std::uint32_t value = 0;
    std::string name = key;
    if (node.json.is_string()) {  // {"1": "spleen"}
        if (!parse_label_value(key, value)) node.fail("must be a whole number, or named by one");
        name = node.text();
    } else {
        value = value_of(node);
    }
    return {.value = value, .name = name, .rgb = label_color(value)};
}

}  // namespace

LabelTable read_own_labels(const LabelText& text) {
    Json json;
    if (is_deeper_than(64, text.text)) text.fail("is nested more than 64 deep");
    try {
        json = Json::parse(text.text);
    } catch (const Json::exception& error) {
        text.fail(json_trouble(error));
    }
    if (const auto twice = json_contradiction(text.text); !twice.empty()) text.fail(twice);
    const JsonNode root{json, text.name, ""};
    root.require_object();
    const JsonNode labels = root.has("labels") ? root.at("labels") : root;
    LabelTable table;
    if (labels.json.is_array()) {
        root.require_keys({"labels"});
        table.format = "Chiaro";
        for (std::size_t i = 0; i < labels.json.size(); ++i) table.labels.push_back(own_label(labels.at(i)));
    } else {
        labels.require_object();
        table.format = "class list";
        for (const auto& [key, value] : labels.json.items()) table.labels.push_back(class_of(labels, key));
    }
    if (table.labels.empty()) text.fail("holds no label");
    return table;
}

}  // namespace chiaro
