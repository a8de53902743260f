#include "core/crc32c.h"

#include <array>
#include <bit>
#include <cstring>

namespace chiaro {
namespace {

using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

/// [n][b]: what byte b becomes with n bytes of zeros behind it.
constexpr Tables tables = [] {
    Tables all{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t value = i;
        for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0x82f63b78 : 0);
        all[0][i] = value;
    }
    for (std::size_t n = 1; n < 8; ++n)
        for (std::size_t i = 0; i < 256; ++i) all[n][i] = all[n - 1][i] >> 8 ^ all[0][all[n - 1][i] & 255];
    return all;
}();

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) {
    static_assert(std::endian::native == std::endian::little);
    std::uint32_t sum = ~0u;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, bytes.data(), sizeof eight);
        eight ^= sum;
        sum = 0;
        for (std::size_t i = 0; i < 8; ++i) sum ^= tables[7 - i][eight >> 8 * i & 255];
    }
    for (const std::byte b : bytes) sum = sum >> 8 ^ tables[0][(sum ^ std::uint32_t(b)) & 255];
    return ~sum;
}

}  // namespace chiaro
