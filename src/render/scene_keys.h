// The keys of a scene file: finding them, setting them, and telling which ones nobody knows.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

using Json = nlohmann::ordered_json;  ///< as it is written: in the settings' order
using ReadJson = nlohmann::json;      ///< as it is read: ordered_json takes O(n²) for n keys

/// The value at a dotted key ("camera.fit_scale"); nullptr when it is missing or null. Throws Error{input} when a part
/// of the way is no object.
const ReadJson* find(const ReadJson& root, std::string_view key);

/// The value at a dotted key, made with the objects on the way to it.
Json& at(Json& root, std::string_view key);

/// The keys, with the path to them and "did you mean", that are no keys of a scene: the first eight by name, the last
/// of them with the number of all others. O(n) in the size of the scene.
std::vector<std::string> unknown_keys_of(const ReadJson& root);

}  // namespace chiaro
