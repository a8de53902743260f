#include "image/hdr.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] { chiaro::decode_hdr(fuzz::bytes(data, size), "input"); });
}
