#include <chiaro/device.h>
#include <chiaro/error.h>
#include <cpuid.h>

#include <algorithm>

#include "core/isa.h"
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
/// Processors with 16-bit floats of AVX-512 (leaf 7, bit 23 of EDX; clang 14 has no name for it).
bool has_avx512_fp16() {
    unsigned eax, ebx, ecx, edx;
    return __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) && (edx >> 23 & 1);
}
/// All with AVX-512 would run it, but gathers are slow on Intel's older processors, those without 16-bit floats (since
/// the mitigation of "Downfall", 2023, much slower), and on AMD's.
bool gathers_fast() { return runs_v4() && __builtin_cpu_is("intel") && has_avx512_fp16(); }

bool this_machine_runs(Isa isa) {
    switch (isa) {
        case Isa::scalar:
            return true;
        case Isa::x86_64_v2:
            return runs_v2();
        case Isa::x86_64_v3:
            return runs_v3();
        case Isa::x86_64_v4:
            return runs_v4();
        case Isa::x86_64_v4_gather:
            return gathers_fast();
    }
    return false;
}

std::string names_of(const std::vector<Isa>& isas) {
    std::string names;
    for (const Isa isa : isas) names += (names.empty() ? "" : ", ") + std::string(name_of(isa));
    return names;
}

}  // namespace

std::string_view name_of(Isa isa) {
    constexpr std::string_view names[] = {"scalar", "x86-64-v2", "x86-64-v3", "x86-64-v4", "x86-64-v4-gather"};
    return names[int(isa)];
}

std::vector<Isa> built_isas() {
    constexpr bool is_built[] = CHIARO_BUILT_ISAS;
    std::vector<Isa> isas;
    for (const Isa isa : all_isas)
        if (is_built[int(isa)]) isas.push_back(isa);
    return isas;
}

bool built_with_cuda() {
#ifdef CHIARO_WITHOUT_CUDA
    return false;
#else
    return true;
#endif
}

std::vector<Isa> available_isas() {
    std::vector<Isa> isas = built_isas();
    std::erase_if(isas, [](Isa isa) { return !this_machine_runs(isa); });
    return isas;
}

Isa best_isa() { return available_isas().back(); }

Device Device::cpu(int threads) { return cpu(threads, best_isa()); }

Device Device::cpu(int threads, Isa isa) {
    if (threads < 0 || threads > 1024)
        throw Error(ErrorCode::usage, "threads " + std::to_string(threads) + ": must be 0 (all) to 1024");
    const auto isas = built_isas();
    if (std::find(isas.begin(), isas.end(), isa) == isas.end())
        throw Error(ErrorCode::output, "this build has no kernels for " + std::string(name_of(isa)) + ", only for " +
                                           names_of(isas) + " (CMake option CHIARO_KERNELS)");
    if (!this_machine_runs(isa))
        throw Error(ErrorCode::output, "this CPU does not run " + std::string(name_of(isa)) + " (at most " +
                                           std::string(name_of(best_isa())) + ")");
    return {threads == 0 ? usable_threads() : threads, isa};
}

}  // namespace chiaro
