// Collective steps of several ranks (Exchange): what goes wrong on one of them ends the step on all.
#pragma once
#include <chiaro/device.h>

#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

namespace chiaro {

/// The blocks of all ranks, by rank; for work done `collectively`. Throws what another rank's work threw.
std::vector<std::vector<std::byte>> gather(const Device& device, std::span<const std::byte> mine);

/// The same of one value each.
template <class T>
std::vector<T> gather_values(const Device& device, const T& mine) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> all;
    for (const auto& bytes : gather(device, std::as_bytes(std::span(&mine, 1))))
        std::memcpy(&all.emplace_back(), bytes.data(), sizeof(T));
    return all;
}

/// Runs work that gathers. Where it throws on one rank it throws on all, each at its next gather or at the end: none
/// waits for a rank that does not come. Does nothing more than the work where there is one rank.
void collectively(const Device& device, const std::function<void()>& work);

}  // namespace chiaro
