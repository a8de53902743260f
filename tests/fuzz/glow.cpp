#include "fuzz.h"
#include "illumination/histogram/emission_mapping.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto value_of = [](const chiaro::EmissionMapping& emission) {
        if (!(emission.at(10) >= 1)) std::abort();
    };
    fuzz::refusing([&] { value_of(chiaro::EmissionMapping{"1:2=" + fuzz::text(data, size)}); }, true);
    return fuzz::refusing([&] { value_of(chiaro::EmissionMapping{fuzz::file_with(data, size, ".txt")}); });
}
