#include "render/scene_labels.h"

#include <fmt/format.h>

namespace chiaro {
namespace {

[[noreturn]] void refuse(std::size_t i, const std::string& what) {
    throw Error(ErrorCode::input, fmt::format("labels.changes[{}]: {}", i, what));
}

double share_of(const ReadJson& json, std::size_t i, const char* name) {
    if (!json.is_number() || !(json.get<double>() >= 0 && json.get<double>() <= 1))
        refuse(i, fmt::format("{}: must be from 0 to 1", name));
    return json.get<double>();
}

LabelChange read_change(const ReadJson& json, std::size_t i) {
    LabelChange change;
    if (!json.is_object()) refuse(i, "must be an object");
    if (const ReadJson* value = find(json, "value")) {
        constexpr std::uint64_t most = 0xffffffff;
        if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most)
            refuse(i, "value: must be a whole number from 0 to 4294967295");
        change.value = value->get<std::uint32_t>();
    }
    if (const ReadJson* rgb = find(json, "rgb")) {
        if (!rgb->is_array() || rgb->size() != 3) refuse(i, "rgb: must be three numbers");
        change.rgb = {share_of((*rgb)[0], i, "rgb"), share_of((*rgb)[1], i, "rgb"), share_of((*rgb)[2], i, "rgb")};
    }
    if (const ReadJson* tint = find(json, "tint")) change.tint = share_of(*tint, i, "tint");
    if (const ReadJson* opacity = find(json, "opacity")) change.opacity = share_of(*opacity, i, "opacity");
    if (const ReadJson* show = find(json, "show")) {
        if (!show->is_boolean()) refuse(i, "show: must be true or false");
        change.show = show->get<bool>();
    }
    return change;
}

}  // namespace

std::vector<LabelChange> read_label_changes(const ReadJson& root) {
    const ReadJson* list = find(root, "labels.changes");
    if (!list) return {};
    if (!list->is_array() || list->size() > max_labels)
        throw Error(ErrorCode::input, fmt::format("labels.changes: must be a list of at most {}", max_labels));
    std::vector<LabelChange> changes;
    for (const ReadJson& change : *list) changes.push_back(read_change(change, changes.size()));
    return changes;
}

void write_label_changes(const std::vector<LabelChange>& changes, Json& root) {
    for (const LabelChange& change : changes) {
        Json json = Json::object();
        if (change.value) json["value"] = *change.value;
        if (change.rgb) json["rgb"] = *change.rgb;
        if (change.tint) json["tint"] = *change.tint;
        if (change.opacity) json["opacity"] = *change.opacity;
        if (change.show) json["show"] = *change.show;
        root["labels"]["changes"].push_back(std::move(json));
    }
}

}  // namespace chiaro
