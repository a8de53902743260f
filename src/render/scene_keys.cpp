#include "render/scene_keys.h"

#include <chiaro/describe.h>
#include <chiaro/error.h>

#include <set>

#include "core/did_you_mean.h"
#include "core/text.h"

namespace chiaro {
namespace {

/// Keys that no setting describes: the scene's own, and those that only inform (a benchmark's, an author's).
constexpr std::string_view other_keys[] = {"chiaro",
                                           "note",
                                           "bench",
                                           "conventions",
                                           "volume.file",
                                           "volume.generator",
                                           "camera.model",
                                           "channels.file",
                                           "channels.name",
                                           "channels.transfer_function",
                                           "channels.gain",
                                           "channels.show",
                                           "labels.changes",
                                           "labels.changes.value",
                                           "labels.changes.rgb",
                                           "labels.changes.tint",
                                           "labels.changes.opacity",
                                           "labels.changes.show",
                                           "iso.value",
                                           "iso.color",
                                           "iso.opacity",
                                           "transfer_function.file",
                                           "transfer_function.preset",
                                           "transfer_function.points",
                                           "transfer_function.points.value",
                                           "transfer_function.points.rgb",
                                           "transfer_function.points.opacity",
                                           "transfer_function.gradient_opacity",
                                           "transfer_function.gradient_opacity.magnitude",
                                           "transfer_function.gradient_opacity.opacity",
                                           "transfer_function.widgets",
                                           "transfer_function.widgets.shape",
                                           "transfer_function.widgets.value",
                                           "transfer_function.widgets.magnitude",
                                           "transfer_function.widgets.opacity",
                                           "transfer_function.rgb_space",
                                           "transfer_function.name",
                                           "marks.kind",
                                           "marks.points",
                                           "marks.text",
                                           "probe.file",
                                           "probe.preset"};

std::set<std::string> known_keys() {
    std::set<std::string> keys(std::begin(other_keys), std::end(other_keys));
    Scene scene;
    for_each_setting([&](const Setting& setting, const auto&...) { keys.emplace(setting.key); }, scene);
    return keys;
}

/// Collects what is unknown below `value`. `shown` is its path with positions in lists, `key` the path without.
class Search {
public:
    Search() {
        for (const std::string& key : known_)
            for (std::size_t dot = key.find('.'); dot != key.npos; dot = key.find('.', dot + 1))
                parents_.insert(key.substr(0, dot));
    }

    std::vector<std::string> found() {
        if (others_ > 0) found_.back() += " (and " + std::to_string(others_) + " others)";
        return found_;
    }

    void below(const ReadJson& value, const std::string& shown, const std::string& key) {
        if (value.is_array()) {
            for (std::size_t i = 0; i < value.size(); ++i) below(value[i], shown + "[" + std::to_string(i) + "]", key);
        } else if (value.is_object()) {
            const std::string dot = key.empty() ? "" : ".";
            for (const auto& [name, child] : value.items()) member(child, shown + dot + name, key + dot + name);
        }
    }

private:
    void member(const ReadJson& value, const std::string& shown, const std::string& key) {
        if (parents_.contains(key))
            below(value, shown, key);
        else if (!known_.contains(key))
            tell(shown, key);
    }

    void tell(const std::string& shown, const std::string& key) {
        constexpr std::size_t told = 8, longest = 200;
        if (found_.size() == told)
            ++others_;
        else
            found_.push_back(one_line(shown, longest) + did_you_mean(key.substr(key.rfind('.') + 1), siblings(key)));
    }

    /// Names of the known keys in the same object.
    std::vector<std::string> siblings(const std::string& key) const {
        const std::string parent = key.substr(0, key.rfind('.') + 1);
        std::vector<std::string> names;
        for (const std::string& known : known_)
            if (known.starts_with(parent))
                names.push_back(known.substr(parent.size(), known.find('.', parent.size()) - parent.size()));
        return names;
    }

    const std::set<std::string> known_ = known_keys();
    std::set<std::string> parents_;  ///< of known keys
    std::vector<std::string> found_;
    std::size_t others_ = 0;
};

}  // namespace

const ReadJson* find(const ReadJson& root, std::string_view key) {
    const ReadJson* value = &root;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        if (!value->is_object())
            throw Error(ErrorCode::input, std::string(key.substr(0, begin ? begin - 1 : 0)) + ": must be an object");
        const auto next = value->find(std::string(key.substr(begin, end - begin)));
        if (next == value->end() || next->is_null()) return nullptr;
        value = &*next;
        begin = end + 1;
    }
    return value;
}

Json& at(Json& root, std::string_view key) {
    Json* value = &root;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        value = &(*value)[std::string(key.substr(begin, end - begin))];
        begin = end + 1;
    }
    return *value;
}

std::vector<std::string> unknown_keys_of(const ReadJson& root) {
    Search search;
    search.below(root, "", "");
    return search.found();
}

}  // namespace chiaro
