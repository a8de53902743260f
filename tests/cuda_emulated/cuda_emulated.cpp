#include <cuda_runtime_api.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

struct EmulatedStream {
    std::vector<std::function<void()>> work;
    bool is_busy = false;  ///< with more than memory that is let go of
};

namespace {

/// Memory of the GPU: pages of its own, the last byte (but for 16 at most) at their end, and one more page that none
/// may touch.
struct Block {
    char* pages;
    std::size_t mapped, usable, bytes;
};

std::recursive_mutex guard;  // one thing at a time
std::map<char*, Block> blocks;
thread_local cudaError_t last_error = cudaSuccess;

cudaError_t told(cudaError_t error) {
    if (error != cudaSuccess) last_error = error;
    return error;
}

void protect(int how) {
    for (const auto& [memory, block] : blocks) mprotect(block.pages, block.usable, how);
}
/// While it lives the GPU may touch its memory, and so may the host, which does nothing meanwhile.
struct Opened {
    Opened() { protect(PROT_READ | PROT_WRITE); }
    ~Opened() { protect(PROT_NONE); }
};

bool is_on_gpu(const void* pointer, std::size_t bytes) {
    const char* at = static_cast<const char*>(pointer);
    auto block = blocks.upper_bound(const_cast<char*>(at));
    if (block == blocks.begin()) return false;
    --block;
    return at + bytes <= block->first + block->second.bytes;
}

[[noreturn]] void end(const char* why) {
    std::fprintf(stderr, "emulated GPU: %s\n", why);
    std::abort();
}

void free_block(void* memory) {
    const auto block = blocks.find(static_cast<char*>(memory));
    if (block == blocks.end()) end("what is freed is not the GPU's");
    cuda_emulated::gpu().held_bytes -= block->second.bytes;
    munmap(block->second.pages, block->second.mapped);
    blocks.erase(block);
}

void later(cudaStream_t stream, std::function<void()> work) {
    const std::lock_guard lock(guard);
    stream->work.push_back(std::move(work));
    stream->is_busy = true;
}

}  // namespace

const char* cudaGetErrorString(cudaError_t error) {
    switch (error) {
        case cudaErrorMemoryAllocation:
            return "out of memory";
        case cudaErrorIllegalAddress:
            return "an illegal memory access was encountered";
        case cudaErrorInvalidConfiguration:
            return "invalid configuration argument";
        case cudaErrorInvalidDevice:
            return "invalid device ordinal";
        default:
            return "some error";
    }
}
cudaError_t cudaGetLastError() { return std::exchange(last_error, cudaSuccess); }
cudaError_t cudaDriverGetVersion(int* version) { return *version = cuda_emulated::gpu().driver_version, cudaSuccess; }
cudaError_t cudaRuntimeGetVersion(int* version) { return *version = 13000, cudaSuccess; }
cudaError_t cudaGetDeviceCount(int* count) {
    *count = cuda_emulated::gpu().count;
    if (cuda_emulated::gpu().driver_version < 13000) return told(cudaErrorInsufficientDriver);
    return *count ? cudaSuccess : told(cudaErrorNoDevice);
}
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
    *properties = {"Emulated", 9, 0};
    return cudaSuccess;
}
cudaError_t cudaSetDevice(int index) {
    return index < cuda_emulated::gpu().count ? cudaSuccess : told(cudaErrorInvalidDevice);
}
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* all) {
    const std::lock_guard lock(guard);
    *all = cuda_emulated::gpu().memory_bytes;
    *free = *all - std::min(*all, cuda_emulated::gpu().held_bytes);
    return cudaSuccess;
}
cudaError_t cudaDeviceGetDefaultMemPool(cudaMemPool_t*, int) { return cudaSuccess; }
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*) { return cudaSuccess; }

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
    return *stream = new EmulatedStream, cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
    cudaStreamSynchronize(stream);
    delete stream;
    return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
    const std::lock_guard lock(guard);
    if (!stream->work.empty()) {
        cuda_emulated::gpu().waits += std::exchange(stream->is_busy, false);
        const Opened opened;
        for (const auto& work : std::exchange(stream->work, {})) work();
    }
    return told(std::exchange(cuda_emulated::gpu().next_wait, cudaSuccess));
}

cudaError_t cudaMallocAsync(void** memory, std::size_t bytes, cudaStream_t) {
    const std::lock_guard lock(guard);
    auto& gpu = cuda_emulated::gpu();
    if (bytes > gpu.memory_bytes - std::min(gpu.memory_bytes, gpu.held_bytes)) return told(cudaErrorMemoryAllocation);
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE)), usable = (bytes + page - 1) / page * page;
    Block block{nullptr, usable + page, usable, bytes};
    void* pages = mmap(nullptr, block.mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) return told(cudaErrorMemoryAllocation);
    block.pages = static_cast<char*>(pages);
    char* first = block.pages + (usable - bytes) / 16 * 16;
    blocks[first] = block;
    gpu.held_bytes += bytes;
    return *memory = first, cudaSuccess;
}
cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream) {
    const std::lock_guard lock(guard);
    return stream->work.push_back([=] { free_block(memory); }), cudaSuccess;
}
cudaError_t cudaFree(void* memory) {
    const std::lock_guard lock(guard);
    return free_block(memory), cudaSuccess;
}
cudaError_t cudaMallocHost(void** memory, std::size_t bytes) {
    if (cuda_emulated::gpu().host_memory != cudaSuccess) return told(cuda_emulated::gpu().host_memory);
    *memory = std::malloc(bytes);
    return *memory ? cudaSuccess : told(cudaErrorMemoryAllocation);
}
cudaError_t cudaFreeHost(void* memory) { return std::free(memory), cudaSuccess; }

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream) {
    const std::lock_guard lock(guard);
    const bool up = kind == cudaMemcpyHostToDevice, down = kind == cudaMemcpyDeviceToHost;
    if ((!up && !is_on_gpu(from, bytes)) || (!down && !is_on_gpu(to, bytes)))
        end("a copy that leaves the GPU's memory");
    if (up) ++cuda_emulated::gpu().uploads, cuda_emulated::gpu().uploaded_bytes += bytes;
    if (down) cuda_emulated::gpu().downloaded_bytes += bytes;
    later(stream, [=] { std::memcpy(to, from, bytes); });
    return cudaSuccess;
}
cudaError_t cudaMemsetAsync(void* memory, int value, std::size_t bytes, cudaStream_t stream) {
    const std::lock_guard lock(guard);
    if (!is_on_gpu(memory, bytes)) end("zeros beyond the GPU's memory");
    later(stream, [=] { std::memset(memory, value, bytes); });
    return cudaSuccess;
}

namespace cuda_emulated {

Gpu& gpu() {
    static Gpu the_gpu;
    return the_gpu;
}

/// Any word that could be read on the host is taken for a pointer: numbers that look like mapped addresses are too rare
/// to matter.
void refuse_host_pointers(const void* argument, const unsigned char* counts, std::size_t bytes) {
    const std::lock_guard lock(guard);
    const std::uintptr_t page = std::uintptr_t(sysconf(_SC_PAGESIZE));
    for (std::size_t at = 0; at + sizeof(std::uintptr_t) <= bytes; at += sizeof(std::uintptr_t)) {
        std::uintptr_t word, counted;
        std::memcpy(&word, static_cast<const char*>(argument) + at, sizeof word);
        std::memcpy(&counted, counts + at, sizeof counted);
        word &= counted;
        unsigned char in_core;
        if (word < 65536 || word >> 47 || is_on_gpu(reinterpret_cast<const void*>(word), 1)) continue;
        if (mincore(reinterpret_cast<void*>(word & ~(page - 1)), 1, &in_core) != 0) continue;
        std::fprintf(stderr, "byte %zu of %zu: %zx\n", at, bytes, std::size_t(word));
        end("a kernel is handed a pointer of the host");
    }
}

void start(void* stream, dim3 grid, dim3 block, std::function<void()> thread) {
    const std::size_t threads = std::size_t(block.x) * block.y * block.z;
    if (!grid.x || !grid.y || !grid.z || grid.y > 65535 || grid.z > 65535 || threads == 0 || threads > 1024) {
        told(cudaErrorInvalidConfiguration);
        return;
    }
    if (told(std::exchange(gpu().next_launch, cudaSuccess)) != cudaSuccess) return;
    ++gpu().launches, gpu().threads += std::size_t(grid.x) * grid.y * grid.z * threads, gpu().last_stream = stream;
    later(static_cast<cudaStream_t>(stream), [=] {
        gridDim = grid, blockDim = block;
        for (unsigned b = 0; b < grid.x * grid.y * grid.z; ++b) {
            blockIdx = dim3(b % grid.x, b / grid.x % grid.y, b / grid.x / grid.y);
            for (unsigned t = 0; t < threads; ++t) {
                threadIdx = dim3(t % block.x, t / block.x % block.y, t / block.x / block.y);
                thread();
            }
        }
    });
}

}  // namespace cuda_emulated
