#include "fuzz.h"
#include "io/raw.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    chiaro::completed_layout({}, fuzz::text(data, size));
    return 0;
}
