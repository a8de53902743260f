// Behind the right name, key and checksum: what a forged file could hold.
#include "fuzz.h"
#include "illumination/histogram/cache.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    chiaro::parse_local_histograms(fuzz::bytes(data, size));
    return 0;
}
