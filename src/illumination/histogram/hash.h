// Checksums of data.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "illumination/histogram/random.h"

namespace chiaro {

/// Not against forgers: tells data apart, and damage. Four chains side by side, eight bytes a step.
inline std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t seed = 0) {
    std::uint64_t chain[4] = {seed, seed + 1, seed + 2, seed + 3};
    std::size_t at = 0;
    for (; at + 32 <= bytes.size(); at += 32)
        for (std::size_t c = 0; c < 4; ++c) {
            std::uint64_t codeword;
            std::memcpy(&codeword, bytes.data() + at + 8 * c, 8);
            chain[c] = (chain[c] ^ codeword) * 0x9fb21c651e98df25;
            chain[c] ^= chain[c] >> 29;
        }
    std::uint64_t sum = mixed(bytes.size() + seed);
    for (std::uint64_t c : chain) sum = mixed(sum ^ c);
    for (; at < bytes.size(); ++at) sum = mixed(sum ^ std::uint64_t(bytes[at]));
    return sum;
}
inline std::uint64_t hash_of(std::string_view text, std::uint64_t seed = 0) {
    return hash_of(std::as_bytes(std::span(text.data(), text.size())), seed);
}

}  // namespace chiaro
