// A value in a JSON file with the path that leads to it, for messages such as "tf.json: points[2].opacity ...".
#pragma once
#include <chiaro/error.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/did_you_mean.h"
#include "core/text.h"

namespace chiaro {

using Json = nlohmann::json;

struct JsonNode {
    const Json& json;
    const std::string& origin;  ///< the file
    std::string path;

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::input, origin + ": " + one_line((path.empty() ? "" : path + " ") + what));
    }
    [[noreturn]] void fail_type(const std::string& wanted) const {
        fail("is " + std::string(json.type_name()) + ": must be " + wanted);
    }
    bool has(const std::string& key) const { return json.is_object() && json.contains(key); }
    JsonNode at(const std::string& key) const {
        if (!json.contains(key)) fail("lacks '" + key + "'");
        return {json.at(key), origin, path.empty() ? key : path + "." + key};
    }
    JsonNode at(std::size_t i) const { return {json.at(i), origin, path + "[" + std::to_string(i) + "]"}; }
    double number() const {
        if (!json.is_number()) fail_type("a number");
        return json.get<double>();
    }
    std::string text() const {
        if (!json.is_string()) fail_type("text");
        return json.get<std::string>();
    }
    /// true, false, 0 or 1
    bool flag() const {
        if (json.is_number()) return json.get<double>() != 0;
        if (!json.is_boolean()) fail_type("true, false, 0 or 1");
        return json.get<bool>();
    }
    void require_object() const {
        if (!json.is_object()) fail_type("an object");
    }
    void require_keys(const std::vector<std::string>& known) const {
        require_object();
        for (const auto& [key, value] : json.items())
            if (std::find(known.begin(), known.end(), key) == known.end())
                fail((path.empty() ? "" : "has ") + ("unknown key '" + key + "'") + did_you_mean(key, known));
    }
};

/// "[json.exception.parse_error.101] parse error at line 3, column 7: ..." without its number.
inline std::string json_trouble(const Json::exception& error) {
    const std::string what = error.what();
    return "is not JSON: " + one_line(what.substr(std::min(what.find("] ") + 2, what.size())));
}

}  // namespace chiaro
