#include "lists.h"

#include <chiaro/chiaro.h>
#include <chiaro/video.h>

#include <cmath>

namespace chiaro::server {
namespace {

Json limit(double value) { return std::isfinite(value) ? Json(value) : Json(); }

template <class T>
struct Inner {
    using type = T;
};
template <class T>
struct Inner<std::optional<T>> {
    using type = T;
};

Json choices_in(std::string_view form) {
    Json choices = Json::array();
    for (std::size_t begin = 0; begin <= form.size();) {
        const std::size_t end = std::min(form.find('|', begin), form.size());
        choices.push_back(form.substr(begin, end - begin));
        begin = end + 1;
    }
    return choices;
}

/// What kind of control suits the field.
template <class Field>
void tell_kind(Json& json, const Setting& setting, const Field&) {
    using T = typename Inner<Field>::type;
    const bool is_choice = setting.form.find('|') != setting.form.npos;
    json["kind"] = "form";
    if constexpr (Named<T>) {
        json["kind"] = "choice";
        for (const std::string_view name : names_of(T{})) json["choices"].push_back(name);
    } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, int>) {
        json["kind"] = is_choice ? "choice" : std::is_same_v<T, bool> ? "switch" : "integer";
        if (is_choice) json["choices"] = choices_in(setting.form);
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
        json["kind"] = "integer";
    } else if constexpr (std::is_same_v<T, double>) {
        json["kind"] = "number";
    } else if constexpr (std::is_same_v<T, std::string>) {
        json["kind"] = "text";
    }
}
void tell_kind(Json& json, const Setting&, const auto&...) { json["kind"] = "form"; }

/// What a scene by this method keeps of the defaults.
Json defaults_of(std::string_view method) {
    Scene scene;
    if (!method.empty()) from_text(method, scene.illumination.method);
    scene.slices.at_mm.emplace();  // scenes leave out slices that nobody has set
    Json json = Json::parse(to_json(scene));
    json["slices"].erase("at");
    return json;
}

Json value_at(const Json& scene, std::string_view key) {
    const Json* value = &scene;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        const auto found = value->is_object() ? value->find(std::string(key.substr(begin, end - begin))) : value->end();
        if (!value->is_object() || found == value->end()) return {};
        value = &*found;
        begin = end + 1;
    }
    return *value;
}

/// The lighting methods that a setting belongs to; none: every picture.
std::vector<std::string> methods_of(const Setting& setting) {
    std::vector<std::string> methods;
    for (const MethodInfo& method : list_methods())
        if (setting.belongs_to(method.name)) methods.push_back(method.name);
    return methods;
}

template <class... Fields>
Json told(const Setting& setting, const Fields&... fields) {
    const std::vector<std::string> methods = methods_of(setting);
    Json json{{"flag", setting.name.empty() ? Json() : Json(setting.name)},
              {"key", setting.key},
              {"unit", setting.unit},
              {"sentence", setting.sentence},
              {"lowest", limit(setting.lowest)},
              {"highest", limit(setting.highest)},
              {"lowest_excluded", setting.lowest_excluded},
              {"default", value_at(defaults_of(methods.empty() ? "" : methods.front()), setting.key)},
              {"default_text", value_text(setting, fields...)},
              {"choices", Json::array()},
              {"form", setting.form.empty() ? form_of(fields...) : std::string(setting.form)},
              {"repeats", setting.repeats()},
              {"methods", methods},
              {"method", methods.size() == 1 ? methods.front() : ""}};
    tell_kind(json, setting, fields...);
    return json;
}

Json settings() {
    Json groups = Json::array();
    const Scene scene;
    for_each_group(
        [&](std::string_view title, const auto& group) {
            Json members = Json::array();
            describe(
                [&](const Setting& setting, const auto&... fields) { members.push_back(told(setting, fields...)); },
                group);
            groups.push_back({{"title", title}, {"settings", std::move(members)}});
        },
        scene);
    return groups;
}

}  // namespace

Json lists(const Device& device) {
    Json json{{"settings", settings()},
              {"device", {{"name", device.name()}, {"isa", name_of(device.isa)}, {"threads", device.threads}}}};
    for (const auto& method : list_methods())
        json["methods"].push_back({{"name", method.name}, {"sentence", method.sentence}});
    for (const auto& preset : list_presets())
        json["presets"].push_back({{"name", preset.name},
                                   {"modality", preset.modality},
                                   {"sentence", preset.sentence},
                                   {"stretched", preset.stretched},
                                   {"is_map", preset.modality.empty()}});
    for (const auto& probe : list_probes())
        json["probes"].push_back({{"name", probe.name}, {"sentence", probe.sentence}});
    for (const auto& sample : list_samples())
        json["samples"].push_back(
            {{"name", sample.name}, {"sentence", sample.sentence}, {"size", sample.default_size}});
    json["films"] = has_ffmpeg() ? Json{"mp4", "webm", "png"} : Json{"png"};
    for (const auto& format : list_formats())
        json["formats"].push_back({{"name", format.name}, {"extensions", format.extensions}, {"note", format.note}});
    return json;
}

}  // namespace chiaro::server
