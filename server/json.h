// What messages are made of.
#pragma once
#include <chiaro/error.h>
#include <chiaro/geometry.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::server {

using Json = nlohmann::json;

/// JSON of a message; text that is no UTF-8 is mended.
std::string text_of(const Json& json);

/// Throws Error{usage} for what is no JSON object, or is nested more than 40 deep (printing recurses).
Json parse_message(std::string_view text);

inline Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Members of a request. Each throws Error{usage} that names the member.
std::string text_in(const Json& request, const char* name, const std::string& otherwise);
std::string text_in(const Json& request, const char* name);
double number_in(const Json& request, const char* name, double lowest, double highest);
int whole_in(const Json& request, const char* name, int lowest, int highest);
bool flag_in(const Json& request, const char* name, bool otherwise);
std::pair<int, int> size_in(const Json& request, const char* name, int most);
const Json& object_in(const Json& request, const char* name);

/// What went wrong, as a message; `re` names the request.
Json error_message(const Json& re, std::string_view code, const std::string& sentence);
/// Of the exception being handled.
Json current_error(const Json& re);

inline std::string as_text(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A binary message: "CHF1", the header's length, the header, the picture.
std::string frame_message(const Json& header, std::string_view image);

}  // namespace chiaro::server
