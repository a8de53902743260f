#include "core/ranks.h"

#include <chiaro/error.h>

#include <string>

namespace chiaro {
namespace {

/// What another rank's work threw.
class FailedElsewhere : public Error {
public:
    using Error::Error;
};

using Blocks = std::vector<std::vector<std::byte>>;

/// Every message begins with what became of its sender: 0, or the code of an error, whose sentence follows.
Blocks exchange(Exchange& ranks, std::byte status, std::span<const std::byte> rest) {
    std::vector<std::byte> message{status};
    message.insert(message.end(), rest.begin(), rest.end());
    return ranks.gather(message);
}

void tell(Exchange& ranks, ErrorCode code, const std::string& sentence) {
    exchange(ranks, std::byte(int(code)), std::as_bytes(std::span(sentence)));
}

}  // namespace

Blocks gather(const Device& device, std::span<const std::byte> mine) {
    if (!device.is_shared()) return {{mine.begin(), mine.end()}};
    Blocks all = exchange(*device.ranks, std::byte(0), mine);
    for (std::size_t rank = 0; rank < all.size(); ++rank)
        if (const auto status = std::to_integer<int>(all[rank].at(0)); status != 0)
            throw FailedElsewhere(
                ErrorCode(status),
                "rank " + std::to_string(rank) + ": " +
                    std::string(reinterpret_cast<const char*>(all[rank].data()) + 1, all[rank].size() - 1));
    for (std::vector<std::byte>& block : all) block.erase(block.begin());
    return all;
}

void collectively(const Device& device, const std::function<void()>& work) {
    if (!device.is_shared()) return work();
    try {
        work();
    } catch (const FailedElsewhere&) {
        throw;
    } catch (const Error& error) {
        tell(*device.ranks, error.code(), error.what());
        throw;
    } catch (const std::exception& error) {
        tell(*device.ranks, ErrorCode::internal, error.what());
        throw;
    }
    gather(device, {});  // all came through
}

}  // namespace chiaro
