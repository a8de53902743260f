// Where the work is done.
#pragma once
#include <chiaro/exchange.h>
#include <chiaro/export.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

/// Instruction sets the kernels are compiled for. `scalar` is the one-pixel-at-a-time reference build;
/// `x86_64_v4_gather` is AVX-512 for processors whose gathers are faster than single loads (Intel's since Sapphire
/// Rapids).
enum class Isa { scalar, x86_64_v2, x86_64_v3, x86_64_v4, x86_64_v4_gather };

inline constexpr Isa all_isas[] = {Isa::scalar, Isa::x86_64_v2, Isa::x86_64_v3, Isa::x86_64_v4, Isa::x86_64_v4_gather};

CHIARO_EXPORT std::string_view name_of(Isa isa);  ///< "scalar", "x86-64-v3", ...
CHIARO_EXPORT std::vector<Isa>
built_isas();  ///< what this build has kernels for (CMake option CHIARO_KERNELS); scalar first
CHIARO_EXPORT std::vector<Isa>
available_isas();                      ///< those of them that this processor runs; scalar first, the best last
CHIARO_EXPORT bool built_with_cuda();  ///< whether this build can use a GPU at all (CMake option CHIARO_CUDA)
CHIARO_EXPORT Isa best_isa();          ///< the last of these; scalar where the build is for newer processors

namespace cuda {
class Stream;  // src/cuda/stream.h
}

/// The CPU, with a number of threads and an instruction set; or beside it an NVIDIA GPU, for the stages that
/// run there (docs/gpu.md). A small value; copies of a GPU's device share its stream, on which work is done in order.
struct Device {
    int threads = 1;
    Isa isa = Isa::scalar;
    std::shared_ptr<cuda::Stream> stream;  ///< of a GPU; none: the CPU does everything
    /// The processes that share what is uploaded; none: this one has all. Then `upload` and `illuminate` are
    /// collective, and work on CPUs only.
    std::shared_ptr<Exchange> ranks = {};

    bool is_shared() const { return ranks && ranks->size() > 1; }

    bool has_gpu() const { return stream != nullptr; }
    CHIARO_EXPORT std::string name() const;  ///< "cpu" or "cuda:0"
    /// The same, with a stream of its own on the GPU, which keeps one copy of what both read.
    CHIARO_EXPORT Device with_own_stream() const;
    /// Why the CPU took over what an automatically chosen GPU could not do, or what any GPU does without
    /// (textures); empty: neither.
    CHIARO_EXPORT std::string note() const;

    /// threads 0: all that the process may use. Throws Error{usage} for threads outside 0..1024 and Error{output}
    /// for an instruction set that this build or this CPU lacks.
    CHIARO_EXPORT static Device cpu(int threads = 0);
    CHIARO_EXPORT static Device cpu(int threads, Isa isa);
    /// GPU `index` of list_gpus(), and `host` for the rest. Throws Error{output} where there is none: why.
    CHIARO_EXPORT static Device cuda(int index, const Device& host);
};

/// A GPU that this build could use.
struct GpuInfo {
    int index = 0;
    std::string name;  ///< "NVIDIA H200"
    std::size_t memory_bytes = 0, free_bytes = 0;
};
/// None without a driver, a GPU, or CUDA in this build.
CHIARO_EXPORT std::vector<GpuInfo> list_gpus();

struct DeviceChoice {
    Device device;
    std::string sentence;  ///< which GPU was chosen, or why not the one there is; empty: there is none
};
/// The GPU with the most free memory where that is 1 GiB or more, else `host`. Where what is shown later does not fit
/// the GPU, the CPU takes over (Device::note).
CHIARO_EXPORT DeviceChoice choose_device(const Device& host);

}  // namespace chiaro
