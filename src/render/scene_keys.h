// The keys of a scene file: finding them, setting them, and telling which ones nobody knows.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

using Json = nlohmann::ordered_json;

/// The value at a dotted key ("camera.fit_scale"); nullptr when it is missing or null. Throws Error{input} when a part
/// of the way is no object.
const Json* find(const Json& root, std::string_view key);

/// The value at a dotted key, made with the objects on the way to it.
Json& at(Json& root, std::string_view key);

/// The keys, with the path to them and "did you mean", that are no keys of a scene.
std::vector<std::string> unknown_keys_of(const Json& root);

}  // namespace chiaro
