#include "io/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace chiaro {
namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

std::uint64_t system_memory() {
    std::ifstream file("/proc/meminfo");
    for (std::string name, unit; file >> name;) {
        std::uint64_t kibibytes = 0;
        if (file >> kibibytes; name == "MemAvailable:") return kibibytes << 10;
        std::getline(file, unit);
    }
    return std::uint64_t(4) << 30;  // no /proc: a careful guess
}

std::uint64_t number_in(const char* path) {
    std::uint64_t value = 0;
    return std::ifstream(path) >> value ? value : unlimited;  // "max" is no number
}

std::uint64_t left_of_control_group() {
    const std::uint64_t limit = number_in("/sys/fs/cgroup/memory.max"),
                        used = number_in("/sys/fs/cgroup/memory.current");
    return limit == unlimited || used == unlimited ? unlimited : limit - std::min(limit, used);
}

}  // namespace

std::uint64_t available_memory() { return std::min(system_memory(), left_of_control_group()); }

}  // namespace chiaro
