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

/// Eight bytes, where there are as many; taken from the beginning of `bytes`.
bool take_eight(std::span<const std::byte>& bytes, std::uint64_t& eight) {
    static_assert(std::endian::native == std::endian::little);
    if (bytes.size() < sizeof eight) return false;
    std::memcpy(&eight, bytes.data(), sizeof eight);
    bytes = bytes.subspan(sizeof eight);
    return true;
}

#if defined(__x86_64__)
[[gnu::target("sse4.2")]] std::uint32_t crc32c_by_instruction(std::span<const std::byte> bytes) {
    std::uint64_t sum = ~0u, eight = 0;
    while (take_eight(bytes, eight)) sum = __builtin_ia32_crc32di(sum, eight);
    auto last = std::uint32_t(sum);
    for (const std::byte b : bytes) last = __builtin_ia32_crc32qi(last, std::uint8_t(b));
    return ~last;
}
#endif

}  // namespace

std::uint32_t crc32c_by_tables(std::span<const std::byte> bytes) {
    std::uint32_t sum = ~0u;
    for (std::uint64_t eight = 0; take_eight(bytes, eight);) {
        eight ^= sum;
        sum = 0;
        for (std::size_t i = 0; i < 8; ++i) sum ^= tables[7 - i][eight >> 8 * i & 255];
    }
    for (const std::byte b : bytes) sum = sum >> 8 ^ tables[0][(sum ^ std::uint32_t(b)) & 255];
    return ~sum;
}

std::uint32_t crc32c(std::span<const std::byte> bytes) {
#if defined(__x86_64__)
    static const bool has_instruction = __builtin_cpu_supports("sse4.2");
    if (has_instruction) return crc32c_by_instruction(bytes);
#endif
    return crc32c_by_tables(bytes);
}

}  // namespace chiaro
