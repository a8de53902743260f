// A GPU for tests where there is none: the few calls of the CUDA runtime that src/cuda makes, and kernels as plain
// functions. It is stricter than a GPU. Work waits in its stream until the host waits for it, so what is read or freed
// too early is wrong every time; memory of the GPU cannot be touched outside of kernels and copies, lies between pages
// that never can be, and a kernel that is handed a pointer of the host ends the test.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>

#define __global__
#define __device__
#define __host__

enum cudaError_t {
    cudaSuccess = 0,
    cudaErrorInvalidValue = 1,
    cudaErrorMemoryAllocation = 2,
    cudaErrorInvalidConfiguration = 9,
    cudaErrorInsufficientDriver = 35,
    cudaErrorDevicesUnavailable = 46,
    cudaErrorNoDevice = 100,
    cudaErrorInvalidDevice = 101,
    cudaErrorECCUncorrectable = 214,
    cudaErrorIllegalAddress = 700,
    cudaErrorLaunchTimeout = 702,
    cudaErrorHardwareStackError = 714,
    cudaErrorIllegalInstruction = 715,
    cudaErrorMisalignedAddress = 716,
    cudaErrorLaunchFailure = 719,
    cudaErrorUnknown = 999
};
enum cudaMemcpyKind { cudaMemcpyHostToDevice = 1, cudaMemcpyDeviceToHost = 2, cudaMemcpyDeviceToDevice = 3 };
enum cudaMemPoolAttr { cudaMemPoolAttrReleaseThreshold = 4 };
enum cudaDeviceAttr {
    cudaDevAttrMaxTexture3DWidth = 24,
    cudaDevAttrMaxTexture3DHeight = 25,
    cudaDevAttrMaxTexture3DDepth = 26
};
constexpr unsigned cudaStreamNonBlocking = 1;
struct cudaDeviceProp {
    char name[256];
    int major, minor;
};
struct dim3 {
    unsigned x = 1, y = 1, z = 1;
    explicit dim3(unsigned x, unsigned y = 1, unsigned z = 1) : x(x), y(y), z(z) {}
    dim3() = default;
};
using cudaStream_t = struct EmulatedStream*;
using cudaMemPool_t = struct EmulatedPool*;

const char* cudaGetErrorString(cudaError_t error);
cudaError_t cudaGetLastError();
cudaError_t cudaDriverGetVersion(int* version);
cudaError_t cudaRuntimeGetVersion(int* version);
cudaError_t cudaGetDeviceCount(int* count);
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int gpu);
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int gpu);
cudaError_t cudaSetDevice(int gpu);
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* all);
cudaError_t cudaDeviceGetDefaultMemPool(cudaMemPool_t* pool, int gpu);
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t pool, cudaMemPoolAttr attribute, void* value);
cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags);
cudaError_t cudaStreamDestroy(cudaStream_t stream);
cudaError_t cudaStreamSynchronize(cudaStream_t stream);
cudaError_t cudaMallocAsync(void** memory, std::size_t bytes, cudaStream_t stream);
cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream);
cudaError_t cudaFree(void* memory);
cudaError_t cudaMallocHost(void** memory, std::size_t bytes);
cudaError_t cudaFreeHost(void* memory);
cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream);
cudaError_t cudaMemsetAsync(void* memory, int value, std::size_t bytes, cudaStream_t stream);

enum cudaChannelFormatKind { cudaChannelFormatKindUnsigned = 1, cudaChannelFormatKindFloat = 2 };
enum cudaTextureAddressMode { cudaAddressModeWrap = 0, cudaAddressModeClamp = 1 };
enum cudaTextureFilterMode { cudaFilterModePoint = 0, cudaFilterModeLinear = 1 };
enum cudaTextureReadMode { cudaReadModeElementType = 0, cudaReadModeNormalizedFloat = 1 };
enum cudaResourceType { cudaResourceTypeArray = 0 };
struct cudaChannelFormatDesc {
    int x, y, z, w;  ///< bits
    cudaChannelFormatKind f;
};
struct cudaExtent {
    std::size_t width, height, depth;
};
struct cudaPos {
    std::size_t x, y, z;
};
struct cudaPitchedPtr {
    void* ptr;
    std::size_t pitch, xsize, ysize;
};
using cudaArray_t = struct EmulatedArray*;
struct cudaMemcpy3DParms {
    cudaArray_t srcArray;
    cudaPos srcPos;
    cudaPitchedPtr srcPtr;
    cudaArray_t dstArray;
    cudaPos dstPos;
    cudaPitchedPtr dstPtr;
    cudaExtent extent;
    cudaMemcpyKind kind;
};
struct cudaResourceDesc {
    cudaResourceType resType;
    struct {
        struct {
            cudaArray_t array;
        } array;
    } res;
};
struct cudaTextureDesc {
    cudaTextureAddressMode addressMode[3];
    cudaTextureFilterMode filterMode;
    cudaTextureReadMode readMode;
    int normalizedCoords;
};
using cudaTextureObject_t = unsigned long long;

cudaError_t cudaMalloc3DArray(cudaArray_t* array, const cudaChannelFormatDesc* format, cudaExtent extent,
                              unsigned flags = 0);
cudaError_t cudaFreeArray(cudaArray_t array);
cudaError_t cudaMemcpy3DAsync(const cudaMemcpy3DParms* copy, cudaStream_t stream);
cudaError_t cudaCreateTextureObject(cudaTextureObject_t* texture, const cudaResourceDesc* resource,
                                    const cudaTextureDesc* lookup, const void* view);
cudaError_t cudaDestroyTextureObject(cudaTextureObject_t texture);
template <class T>
T tex3D(cudaTextureObject_t texture, float x, float y, float z);
template <>
float tex3D<float>(cudaTextureObject_t texture, float x, float y, float z);

inline thread_local dim3 blockIdx, threadIdx, blockDim, gridDim;

template <class T>
T atomicAdd(T* to, T more) {
    return __atomic_fetch_add(to, more, __ATOMIC_RELAXED);
}

namespace cuda_emulated {

/// What a GPU was asked to do so far. Where there is no GPU to measure, this says how far a real one would be kept
/// busy: launches that wait for each other, threads to share them, and how often the host stands in between.
struct GpuCounts {
    std::size_t launches = 0, threads = 0;  ///< threads: of whole blocks
    std::size_t waits = 0;                  ///< of the host, for work that it had asked for
    std::size_t uploads = 0, uploaded_bytes = 0, downloaded_bytes = 0;

    GpuCounts since(const GpuCounts& before) const {
        return {launches - before.launches,
                threads - before.threads,
                waits - before.waits,
                uploads - before.uploads,
                uploaded_bytes - before.uploaded_bytes,
                downloaded_bytes - before.downloaded_bytes};
    }
};

/// What tests set and see.
struct Gpu : GpuCounts {
    int count = 1;
    std::size_t memory_bytes = std::size_t(4) << 30;
    int driver_version = 13000;
    int texture_edge = 16384;               ///< the longest of textures in three dimensions
    cudaError_t next_wait = cudaSuccess;    ///< told by the next cudaStreamSynchronize: what a kernel did wrong
    cudaError_t next_launch = cudaSuccess;  ///< told by the next launch: what it had no room for
    cudaError_t host_memory = cudaSuccess;  ///< told by cudaMallocHost
    const void* last_stream = nullptr;      ///< of the last launch
    std::size_t held_bytes = 0;             ///< allocated and not yet freed
};
Gpu& gpu();

/// `counts`: 0 for bytes that hold anything.
void refuse_host_pointers(const void* argument, const unsigned char* counts, std::size_t bytes);
/// 255, and 0 for padding.
template <class Argument>
struct CountedBytes {
    union Alone {  // GCC 12 forgets padding of and behind long arrays of structs, but not in a union
        Argument argument;
    };
    alignas(Argument) unsigned char at[sizeof(Argument)];
    CountedBytes() {
        std::fill_n(at, sizeof at, 255);
        __builtin_clear_padding(reinterpret_cast<Alone*>(at));
    }
};
template <class Argument>
void refuse_host_pointers_in(const Argument& argument) {
    refuse_host_pointers(&argument, CountedBytes<Argument>().at, sizeof argument);
}
void start(void* stream, dim3 grid, dim3 block, std::function<void()> thread);

template <class... Parameters, class... Arguments>
void launch(void (*kernel)(Parameters...), dim3 grid, dim3 block, void* stream, const Arguments&... arguments) {
    (refuse_host_pointers_in(arguments), ...);
    start(stream, grid, block, [=] { kernel(arguments...); });
}

}  // namespace cuda_emulated
