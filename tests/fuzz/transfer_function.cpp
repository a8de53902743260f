#include "fuzz.h"

#include <chiaro/transfer_function.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        const auto tf = chiaro::parse_transfer_function(fuzz::text(data, size), "input");
        const auto again = chiaro::parse_transfer_function(chiaro::to_json(tf), "own");
        if (again.points != tf.points || again.opacity_unit != tf.opacity_unit) std::abort();
    });
}
