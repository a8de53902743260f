#include <chiaro/device.h>
#include <chiaro/error.h>

#include <algorithm>

#include "core/threads.h"

namespace chiaro {
namespace {

// The micro-architecture levels of the x86-64 psABI, as far as the kernels use them.
bool runs_v2() { return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt"); }
bool runs_v3() {
    return runs_v2() && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
}
bool runs_v4() {
    return runs_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

}  // namespace

std::string_view name_of(Isa isa) {
    constexpr std::string_view names[] = {"scalar", "x86-64-v2", "x86-64-v3", "x86-64-v4"};
    return names[int(isa)];
}

Isa best_isa() {
    return runs_v4() ? Isa::x86_64_v4 : runs_v3() ? Isa::x86_64_v3 : runs_v2() ? Isa::x86_64_v2 : Isa::scalar;
}

std::vector<Isa> available_isas() {
    std::vector<Isa> isas;
    for (int isa = 0; isa <= int(best_isa()); ++isa) isas.push_back(Isa(isa));
    return isas;
}

Device Device::cpu(int threads) { return cpu(threads, best_isa()); }

Device Device::cpu(int threads, Isa isa) {
    if (threads < 0 || threads > 1024)
        throw Error(ErrorCode::usage, "threads " + std::to_string(threads) + ": must be 0 (all) to 1024");
    if (isa > best_isa())
        throw Error(ErrorCode::output, "this CPU does not run " + std::string(name_of(isa)) + " (at most " +
                                           std::string(name_of(best_isa())) + ")");
    return {threads == 0 ? usable_threads() : threads, isa};
}

}  // namespace chiaro
