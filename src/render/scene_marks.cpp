#include "render/scene_marks.h"

#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

[[noreturn]] void refuse_mark(std::size_t i, const std::string& what) {
    throw Error(ErrorCode::input, fmt::format("marks[{}]: {}", i, what));
}

Vec3 read_point(const ReadJson& json, std::size_t i) {
    const auto is_number = [](const ReadJson& c) { return c.is_number() && std::isfinite(c.get<double>()); };
    if (!json.is_array() || json.size() != 3 || !std::all_of(json.begin(), json.end(), is_number))
        refuse_mark(i, "each point must be three numbers, world mm");
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Mark read_mark(const ReadJson& json, std::size_t i) {
    Mark mark;
    if (!json.is_object() || !json.contains("kind") || !json["kind"].is_string())
        refuse_mark(i, "must be an object with a kind");
    constexpr auto kinds = names_of(MarkKind{});
    const auto found = std::find(kinds.begin(), kinds.end(), json["kind"].get<std::string>());
    if (found == kinds.end()) refuse_mark(i, fmt::format("kind: must be one of {}", fmt::join(kinds, ", ")));
    mark.kind = MarkKind(found - kinds.begin());
    const auto [least, most] = mark_points(mark.kind);
    const bool has_points = json.contains("points") && json["points"].is_array();
    const std::size_t count = has_points ? json["points"].size() : 0;
    if (count < least || count > most)
        refuse_mark(i, fmt::format("a {} has {} points", *found,
                                   least == most ? to_text(int(least)) : fmt::format("{} to {}", least, most)));
    for (const ReadJson& point : json["points"]) mark.points_mm.push_back(read_point(point, i));
    if (!json.contains("text") || json["text"].is_null()) return mark;
    if (!json["text"].is_string()) refuse_mark(i, "text: must be text");
    mark.text = json["text"].get<std::string>();
    if (mark.text.size() > max_mark_text) refuse_mark(i, fmt::format("text: at most {} bytes", max_mark_text));
    return mark;
}

}  // namespace

std::vector<Mark> read_marks(const ReadJson& root) {
    const ReadJson* list = find(root, "marks");
    if (!list) return {};
    if (!list->is_array() || list->size() > max_marks)
        throw Error(ErrorCode::input, fmt::format("marks: must be a list of at most {}", max_marks));
    std::vector<Mark> marks;
    for (const ReadJson& mark : *list) marks.push_back(read_mark(mark, marks.size()));
    return marks;
}

void write_marks(const std::vector<Mark>& marks, Json& root) {
    for (const Mark& mark : marks) {
        Json json{{"kind", to_text(mark.kind)}, {"points", Json::array()}};
        for (const Vec3& p : mark.points_mm) json["points"].push_back({p.x, p.y, p.z});
        if (!mark.text.empty()) json["text"] = mark.text;
        root["marks"].push_back(json);
    }
}

}  // namespace chiaro
