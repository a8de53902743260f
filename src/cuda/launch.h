// From a kernel to threads of a GPU, for launch*.cu alone. They are compiled by nvcc; by the compiler of the tests for
// a GPU that these make believe (CHIARO_CUDA_EMULATED, tests/cuda_emulated); and where there is no nvcc by the
// compiler of the library, which then makes nothing of the kernels.
#pragma once
#include <cstdint>

#include "cuda/counters.h"
#include "cuda/run.h"
#include "kernel/lanes.h"

#if defined(__CUDACC__)
#define CHIARO_DEVICE __device__ __forceinline__
#define CHIARO_ARGUMENT const __grid_constant__
#define CHIARO_LAUNCH(kernel, grid, block, stream, ...) \
    kernel<<<grid, block, 0, static_cast<cudaStream_t>((stream).handle())>>>(__VA_ARGS__)
#elif defined(CHIARO_CUDA_EMULATED)
#include <cuda_runtime_api.h>
#define CHIARO_DEVICE inline
#define CHIARO_ARGUMENT const
#define CHIARO_LAUNCH(kernel, grid, block, stream, ...) \
    cuda_emulated::launch(kernel, grid, block, (stream).handle(), __VA_ARGS__)
#else
#define CHIARO_DEVICE inline
unsigned long long atomicAdd(unsigned long long* to, unsigned long long more);  // named, never called
#endif

namespace chiaro::kernel {

#if defined(__CUDA_ARCH__) || defined(CHIARO_CUDA_EMULATED)
CHIARO_INLINE float texel_at(std::uint64_t texture, float x, float y, float z) {
    return tex3D<float>(texture, x, y, z);
}
#else
CHIARO_INLINE float texel_at(std::uint64_t, float, float, float) { return 0; }  // named, never called
#endif

}  // namespace chiaro::kernel

namespace chiaro::cuda {

/// Adds for a pixel: those of a warp to one place.
CHIARO_DEVICE void count(Count* places, std::int32_t pixel, std::int64_t more) {
    atomicAdd(places + (pixel / 32 & (count_places - 1)), Count(more));
}

#ifdef CHIARO_LAUNCH

// Functions that are handed a part of the body read it where it is: without __grid_constant__ every thread copies the
// body to its stack for them.
template <class Body>
__global__ void run_items(CHIARO_ARGUMENT Body body, std::int64_t count) {
    const std::int64_t i = std::int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
    if (i < count) body(i);
}

template <class Body>
__global__ void run_pixels(CHIARO_ARGUMENT Body body, std::int32_t width, std::int32_t height) {
    const std::int32_t x = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    const std::int32_t y = std::int32_t(blockIdx.y * blockDim.y + threadIdx.y);
    if (x < width && y < height) body(x, y);
}

/// body(i) for each i of [0, count), a thread each.
template <class Body>
void launch_items(Stream& stream, std::int64_t count, const Body& body) {
    if (count == 0) return;
    constexpr unsigned threads = 128;
    const dim3 grid(unsigned((count + threads - 1) / threads)), block(threads);
    CHIARO_LAUNCH(run_items<Body>, grid, block, stream, body, count);
    stream.launched();
}

/// body(x, y) for each pixel, a thread each: a warp is 8 × 4 pixels, whose rays pass the same bricks.
template <class Body>
void launch_pixels(Stream& stream, std::int32_t width, std::int32_t height, const Body& body) {
    if (width == 0 || height == 0) return;
    constexpr unsigned edge_x = 8, edge_y = 16;
    const dim3 grid((unsigned(width) + edge_x - 1) / edge_x, (unsigned(height) + edge_y - 1) / edge_y);
    CHIARO_LAUNCH(run_pixels<Body>, grid, dim3(edge_x, edge_y), stream, body, width, height);
    stream.launched();
}

#else

template <class Body>
void launch_items(Stream& stream, std::int64_t, const Body&) {
    stream.launched();
}
template <class Body>
void launch_pixels(Stream& stream, std::int32_t, std::int32_t, const Body&) {
    stream.launched();
}

#endif

}  // namespace chiaro::cuda

namespace chiaro::kernel {

template <class Kernel>
void run_on_gpu(cuda::Stream& stream, std::int64_t count, const Kernel& kernel) {
    cuda::launch_items(stream, count, kernel);
}

}  // namespace chiaro::kernel
