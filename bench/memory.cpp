// What the machine's memory gives one thread: the yardstick of all that moves bytes.
#include <cstdint>
#include <cstring>
#include <numeric>

#include "rows.h"

namespace chiaro::bench {
namespace {

struct Block {
    explicit Block(std::size_t bytes) : from(bytes / 8, 1), to(bytes / 8, 2) {}
    std::vector<std::uint64_t> from, to;
    std::size_t bytes() const { return from.size() * 8; }
    double gb_per_second(double seconds) const { return 1e-9 * double(bytes()) / seconds; }
};

double copy_rate(Block& block) {
    return block.gb_per_second(cpu_seconds([&] { std::memcpy(block.to.data(), block.from.data(), block.bytes()); }));
}

double read_rate(const Block& block) {
    volatile std::uint64_t sum = 0;  // keeps the reading
    return block.gb_per_second(
        cpu_seconds([&] { sum = std::accumulate(block.from.begin(), block.from.end(), std::uint64_t(0)); }));
}

}  // namespace

std::vector<Case> memory_cases(const Setup& setup) {
    const std::size_t bytes = std::size_t(setup.quick ? 64 : 256) << 20;
    const auto measure = [bytes, runs = setup.runs] {
        Block block(bytes);
        const auto series = in_turns(runs, {[&] { return copy_rate(block); }, [&] { return read_rate(block); }});
        return std::vector<Row>{
            {"memory/memcpy", "GB/s", spread_of(series[0])},
            {"memory/read", "GB/s", spread_of(series[1]), median_ratio(series[1], series[0]), "memcpy"}};
    };
    return {{{"memory/memcpy", "memory/read"}, measure}};
}

}  // namespace chiaro::bench
