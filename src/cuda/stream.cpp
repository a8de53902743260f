#include "cuda/texture.h"

#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include <utility>

namespace chiaro::cuda {
namespace {

/// What is freed and held ready for what comes next: one in so many of the GPU's bytes. Transport at 128³ nodes takes
/// more than 512 MiB, which may otherwise be mapped anew for each edit.
constexpr std::size_t kept_share = 8;
constexpr int oldest = 75;  ///< compute capability × 10 that the kernels are compiled for

std::string name_of_gpu(const GpuInfo& gpu) { return fmt::format("cuda:{} ({})", gpu.index, gpu.name); }

bool means_lost(cudaError_t error) {
    switch (error) {
        case cudaErrorIllegalAddress:
        case cudaErrorLaunchFailure:
        case cudaErrorLaunchTimeout:
        case cudaErrorECCUncorrectable:
        case cudaErrorHardwareStackError:
        case cudaErrorIllegalInstruction:
        case cudaErrorMisalignedAddress:
        case cudaErrorDevicesUnavailable:
        case cudaErrorUnknown:
            return true;
        default:
            return false;
    }
}

/// `wanted`: bytes, where memory was asked for.
void check(cudaError_t error, const GpuInfo& gpu, std::size_t wanted = 0) {
    if (error == cudaSuccess) return;
    const std::string told = cudaGetErrorString(error);
    (void)cudaGetLastError();  // else the next call tells it again
    if (error == cudaErrorMemoryAllocation) {
        std::size_t free = 0, all = 0;
        if (cudaMemGetInfo(&free, &all) != cudaSuccess) free = 0, all = gpu.memory_bytes;
        throw OutOfMemory(fmt::format("{}: {} MiB more do not fit: {} of {} MiB are free", name_of_gpu(gpu),
                                      (wanted >> 20) + 1, free >> 20, all >> 20));
    }
    if (means_lost(error))
        throw Error(ErrorCode::output,
                    fmt::format("{} was lost: {}; start again, or use --device cpu", name_of_gpu(gpu), told));
    throw Error(ErrorCode::output, fmt::format("{}: {}", name_of_gpu(gpu), told));
}

cudaStream_t stream_of(void* handle) { return static_cast<cudaStream_t>(handle); }

std::string why_none(cudaError_t error) {
    int driver = 0, runtime = 0;
    (void)cudaDriverGetVersion(&driver);
    (void)cudaRuntimeGetVersion(&runtime);
    (void)cudaGetLastError();
    if (driver == 0) return "there is no NVIDIA driver";
    if (error == cudaErrorInsufficientDriver)
        return fmt::format("the NVIDIA driver is for CUDA {}.{}, and this build needs {}.{}", driver / 1000,
                           driver % 1000 / 10, runtime / 1000, runtime % 1000 / 10);
    if (error == cudaErrorNoDevice || error == cudaSuccess) return "there is no NVIDIA GPU";
    return fmt::format("the NVIDIA driver says: {}", cudaGetErrorString(error));
}

}  // namespace

std::vector<GpuInfo> find_gpus(std::string& why) {
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    std::vector<GpuInfo> gpus;
    if (error != cudaSuccess || count == 0) {
        why = why_none(error);
        return gpus;
    }
    for (int index = 0; index < count; ++index) {
        cudaDeviceProp properties;
        GpuInfo gpu{.index = index};
        if (cudaGetDeviceProperties(&properties, index) != cudaSuccess) continue;
        gpu.name = properties.name;
        if (10 * properties.major + properties.minor < oldest) {
            why = fmt::format("{} is older than what this build runs on (compute capability {}.{})", name_of_gpu(gpu),
                              oldest / 10, oldest % 10);
            continue;
        }
        if (const cudaError_t failed = cudaSetDevice(index); failed != cudaSuccess) {
            why = fmt::format("{} cannot be used: {}", name_of_gpu(gpu), cudaGetErrorString(failed));
            (void)cudaGetLastError();
            continue;
        }
        if (cudaMemGetInfo(&gpu.free_bytes, &gpu.memory_bytes) == cudaSuccess) gpus.push_back(gpu);
    }
    return gpus;
}

Stream::Stream(GpuInfo gpu, std::shared_ptr<DeviceCache> device_cache, bool is_optional)
    : gpu_(std::move(gpu)), device_cache_(std::move(device_cache)), is_optional_(is_optional) {
    use();
    cudaStream_t stream{};
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), gpu_);
    handle_ = stream;
    cudaMemPool_t pool{};
    check(cudaDeviceGetDefaultMemPool(&pool, gpu_.index), gpu_);
    std::uint64_t keep = gpu_.memory_bytes / kept_share;
    check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep), gpu_);
}

Stream::~Stream() {
    if (cudaSetDevice(gpu_.index) != cudaSuccess) return;
    (void)cudaStreamSynchronize(stream_of(handle_));
    (void)cudaStreamDestroy(stream_of(handle_));
    if (landing_) (void)cudaFreeHost(landing_);
}

/// Which GPU is meant is each thread's own state.
void Stream::use() const { check(cudaSetDevice(gpu_.index), gpu_); }

void* Stream::allocate(std::size_t bytes) {
    use();
    void* memory = nullptr;
    check(cudaMallocAsync(&memory, bytes, stream_of(handle_)), gpu_, bytes);
    return memory;
}

void Stream::release(void* memory) noexcept {
    if (cudaSetDevice(gpu_.index) == cudaSuccess) (void)cudaFreeAsync(memory, stream_of(handle_));
}

void Stream::release_at_once(int gpu, void* memory) noexcept {
    if (cudaSetDevice(gpu) == cudaSuccess) (void)cudaFree(memory);
}

std::size_t Stream::free_bytes() const {
    use();
    std::size_t free = 0, all = 0;
    check(cudaMemGetInfo(&free, &all), gpu_);
    return free;
}

void Stream::upload(void* to, const void* from, std::size_t bytes) {
    use();
    check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_of(handle_)), gpu_);
}

void Stream::download(void* to, const void* from, std::size_t bytes) {
    use();
    check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_of(handle_)), gpu_);
}

void Stream::copy(void* to, const void* from, std::size_t bytes) {
    use();
    check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream_of(handle_)), gpu_);
}

void Stream::zero(void* memory, std::size_t bytes) {
    use();
    check(cudaMemsetAsync(memory, 0, bytes, stream_of(handle_)), gpu_);
}

std::byte* Stream::landing(std::size_t bytes) {
    if (bytes <= landing_bytes_) return landing_;
    use();
    if (landing_) check(cudaFreeHost(std::exchange(landing_, nullptr)), gpu_);
    landing_bytes_ = 0;
    void* memory = nullptr;
    check(cudaMallocHost(&memory, bytes), gpu_, bytes);
    landing_ = static_cast<std::byte*>(memory), landing_bytes_ = bytes;
    return landing_;
}

void Stream::launched() { check(cudaGetLastError(), gpu_); }

void Stream::settle() noexcept {
    if (cudaSetDevice(gpu_.index) == cudaSuccess) (void)cudaStreamSynchronize(stream_of(handle_));
}

void Stream::wait() {
    use();
    check(cudaStreamSynchronize(stream_of(handle_)), gpu_);
}

namespace {

int bytes_of(Texel texel) { return texel == Texel::u8 ? 1 : texel == Texel::u16 ? 2 : 4; }

cudaChannelFormatDesc format_of(Texel texel) {
    return {8 * bytes_of(texel), 0, 0, 0,
            texel == Texel::f32 ? cudaChannelFormatKindFloat : cudaChannelFormatKindUnsigned};
}

cudaTextureDesc lookup_of(Texel texel) {
    cudaTextureDesc lookup{};
    for (auto& mode : lookup.addressMode) mode = cudaAddressModeClamp;
    lookup.filterMode = cudaFilterModeLinear;
    lookup.readMode = texel == Texel::f32 ? cudaReadModeElementType : cudaReadModeNormalizedFloat;
    return lookup;
}

void check_edges(const std::array<int, 3>& size, const GpuInfo& gpu) {
    constexpr cudaDeviceAttr longest[] = {cudaDevAttrMaxTexture3DWidth, cudaDevAttrMaxTexture3DHeight,
                                          cudaDevAttrMaxTexture3DDepth};
    for (int axis = 0; axis < 3; ++axis) {
        int most = 0;
        check(cudaDeviceGetAttribute(&most, longest[axis], gpu.index), gpu);
        if (size[std::size_t(axis)] > most)
            throw NoTexture(fmt::format("{}: textures have at most {} voxels along {}, and the volume has {}",
                                        name_of_gpu(gpu), most, "xyz"[axis], size[std::size_t(axis)]));
    }
}

}  // namespace

Texture::Texture(Stream& stream, Texel texel, std::array<int, 3> size) : gpu_(stream.gpu().index), texel_(texel) {
    check(cudaSetDevice(gpu_), stream.gpu());
    check_edges(size, stream.gpu());
    try {
        make(stream.gpu(), size);
    } catch (const OutOfMemory& error) {
        throw NoTexture(error.what());
    }
}

void Texture::make(const GpuInfo& gpu, std::array<int, 3> size) {
    const auto [x, y, z] = size;
    const std::size_t bytes = std::size_t(x) * std::size_t(y) * std::size_t(z) * std::size_t(bytes_of(texel_));
    const cudaChannelFormatDesc format = format_of(texel_);
    cudaArray_t array{};
    check(cudaMalloc3DArray(&array, &format, cudaExtent{std::size_t(x), std::size_t(y), std::size_t(z)}), gpu, bytes);
    cudaResourceDesc resource{};
    resource.resType = cudaResourceTypeArray;
    resource.res.array.array = array;
    const cudaTextureDesc lookup = lookup_of(texel_);
    cudaTextureObject_t handle{};
    const cudaError_t made = cudaCreateTextureObject(&handle, &resource, &lookup, nullptr);
    if (made != cudaSuccess) (void)cudaFreeArray(array);
    check(made, gpu, bytes);
    array_ = array, handle_ = handle;
}

Texture::~Texture() {
    if (cudaSetDevice(gpu_) != cudaSuccess) return;
    (void)cudaDestroyTextureObject(handle_);
    (void)cudaFreeArray(static_cast<cudaArray_t>(array_));
}

void Texture::copy(Stream& stream, const Box& box) {
    const auto elements = [](const std::array<int, 3>& a) {
        return std::array{std::size_t(a[0]), std::size_t(a[1]), std::size_t(a[2])};
    };
    const auto to = elements(box.to), size = elements(box.size);
    const std::size_t row = std::size_t(box.row);
    cudaMemcpy3DParms copy{};
    copy.srcPtr = {const_cast<std::byte*>(box.from), row * std::size_t(bytes_of(texel_)), row, row};
    copy.dstArray = static_cast<cudaArray_t>(array_);
    copy.dstPos = {to[0], to[1], to[2]};
    copy.extent = {size[0], size[1], size[2]};
    copy.kind = cudaMemcpyDeviceToDevice;
    check(cudaSetDevice(gpu_), stream.gpu());
    check(cudaMemcpy3DAsync(&copy, stream_of(stream.handle())), stream.gpu());
}

}  // namespace chiaro::cuda
