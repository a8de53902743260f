#include "core/byte_size.h"

#include <charconv>

namespace chiaro {

std::optional<std::uint64_t> bytes_from(std::string_view text) {
    constexpr std::uint64_t most = std::uint64_t(1) << 50;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit = text.substr(std::size_t(end - text.data()));
    const auto at = std::string_view("KMGT").find(unit.empty() ? ' ' : unit[0]);
    if (error != std::errc() || unit.size() > 1 || (!unit.empty() && at == unit.npos)) return {};
    const double bytes = unit.empty() ? number : number * double(std::uint64_t(1024) << 10 * at);
    if (!(bytes >= 0 && bytes <= double(most))) return {};
    return std::uint64_t(bytes);
}

}  // namespace chiaro
