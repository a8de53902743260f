// Values of scenes, not their syntax: each pair of bytes gives one setting one of the values that programs trip over.
#include <chiaro/describe.h>
#include <chiaro/scene.h>

#include <nlohmann/json.hpp>

#include "fuzz.h"

namespace {

using Json = nlohmann::json;

const std::vector<std::string>& keys() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names{"/chiaro",
                                       "/volume/file",
                                       "/camera/model",
                                       "/probe/file",
                                       "/probe/preset",
                                       "/transfer_function/file",
                                       "/transfer_function/preset",
                                       "/transfer_function/points",
                                       "/transfer_function/rgb_space"};
        chiaro::Scene scene;
        chiaro::for_each_setting(
            [&](const chiaro::Setting& setting, auto&...) {
                std::string name = "/" + std::string(setting.key);
                std::replace(name.begin(), name.end(), '.', '/');
                names.push_back(name);
            },
            scene);
        return names;
    }();
    return all;
}

const Json values =
    Json::parse(R"([null, true, false, 0, -0.0, 1, -1, 2, 0.5, 16, 1e-300, 5e-324, -1e-300, 1e-12, 1e12, 1e300,
    1.7976931348623157e308, -1.7976931348623157e308, 2147483647, 2147483648, -2147483649, 9223372036854775807,
    -9223372036854775808, 18446744073709551615, 1e19, "", " ", "nan", "inf", "-inf", "1e999", "-", "0x10", "1,2,3", ";", "@",
    "sky", "spao", "reference", "transport", "histogram", "visibility", "iso", "mip", "minip", "mean", "additive", "transparent", "probe", "#12345", "anterior",
    [], {}, [[]], [{}], [1], [1, 1], [0, 0, 0], [1e308, 1e308, 1e308], [1, 2, 3, 4], [0, 1, 0, 1, 0, 1], [[0, 0, 0, 1]],
    [{"value": 1e308}], [{"value": 1, "opacity": 2}], [{"value": 1, "color": [9, 9, 9]}],
    [{"value": -1e308, "rgb": [0, 0, 0], "opacity": 0}, {"value": 1e308, "rgb": [1, 1, 1], "opacity": 1}],
    [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]])");

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Json scene{{"volume", {{"file", "sample:ball:8"}}}};
    for (std::size_t i = 0; i + 1 < size && i < 64; i += 2) try {
            scene[Json::json_pointer(keys()[data[i] % keys().size()])] = values[data[i + 1] % values.size()];
        } catch (const Json::exception&) {  // the way there leads through what is no object
        }
    return fuzz::refusing([&] {
        std::vector<std::string> unknown;
        const auto json = chiaro::to_json(chiaro::parse_scene(scene.dump(), "folder", "", unknown));
        if (chiaro::to_json(chiaro::parse_scene(json, "", "", unknown)) != json) std::abort();
    });
}
