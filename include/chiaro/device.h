// Where the work is done.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

/// Instruction sets the kernels are compiled for. `scalar` is the one-pixel-at-a-time reference build.
enum class Isa { scalar, x86_64_v2, x86_64_v3, x86_64_v4 };

std::string_view name_of(Isa isa);  ///< "scalar", "x86-64-v3", ...
Isa best_isa();                     ///< the widest this processor runs
std::vector<Isa> available_isas();  ///< scalar first, the best last

/// The processor, with a number of threads and an instruction set. A small value; nothing is held open.
struct Device {
    int threads = 1;
    Isa isa = Isa::scalar;

    /// threads 0: all that the process may use. Throws Error{usage} for threads outside 0..1024 and Error{output}
    /// for an instruction set that this processor lacks.
    static Device cpu(int threads = 0);
    static Device cpu(int threads, Isa isa);
};

}  // namespace chiaro
