// Others' transfer functions: the first byte chooses the name, and with it what is taken for granted.
#include "fuzz.h"

#include <chiaro/transfer_file.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace chiaro;
    if (size == 0) return 0;
    constexpr const char* names[] = {"a.vp",      "a.itf",           "a.tfi", "a.json",
                                     "a.vp.json", "a.paraview.json", "a",     "a.json#b"};
    Statistics data_range;
    data_range.max = data_range.p99 = data_range.p999 = 200;
    return fuzz::refusing([&] {
        const auto file = parse_transfer_file(fuzz::text(data + 1, size - 1), names[*data % 8], data_range);
        validate(file.function);
        parse_transfer_function(to_json(file.function), "own");
    });
}
