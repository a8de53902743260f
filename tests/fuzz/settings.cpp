// Values of flags: the first byte chooses the setting, the rest is its text.
#include "fuzz.h"

#include <chiaro/describe.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace chiaro;
    if (size == 0) return 0;
    const std::string text = fuzz::text(data + 1, size - 1);
    fuzz::refusing([&] { (void)parse_color(text); }, true);
    return fuzz::refusing(
        [&] {
            Scene scene;
            int number = 0;
            for_each_setting(
                [&](const Setting& setting, auto&... fields) {
                    if (number++ != *data) return;
                    set(setting, text, "it", ErrorCode::usage, fields...);
                    const std::string told = value_text(setting, fields...);
                    if (!told.empty() && !setting.repeats())
                        set(setting, told, "its own text", ErrorCode::internal, fields...);
                },
                scene);
        },
        true);
}
