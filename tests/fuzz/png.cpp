#include "image/png.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] { chiaro::decode_png(fuzz::bytes(data, size), "input"); });
}
