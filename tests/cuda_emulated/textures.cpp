// Texture units of the emulated GPU: eight texels, with weights of 8 fractional bits.
#include <cuda_runtime_api.h>

#include <cmath>
#include <cstring>
#include <vector>

struct EmulatedArray {
    void* memory;
    cudaChannelFormatDesc format;
    cudaExtent extent;

    std::size_t texel_bytes() const { return std::size_t(format.x) / 8; }
    std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
        return (z * extent.height + y) * extent.width + x;
    }
    float texel(const int (&at)[3]) const {
        const auto inside = [](int i, std::size_t n) { return std::size_t(std::clamp(i, 0, int(n) - 1)); };
        const std::size_t i =
            index(inside(at[0], extent.width), inside(at[1], extent.height), inside(at[2], extent.depth));
        if (format.x == 8) return float(static_cast<const std::uint8_t*>(memory)[i]) / 255;
        if (format.x == 16) return float(static_cast<const std::uint16_t*>(memory)[i]) / 65535;
        return static_cast<const float*>(memory)[i];
    }
};

namespace {

std::vector<const EmulatedArray*> textures;  // a handle is one more than a place; places are not used again

/// A texel and its share of the way to the next.
struct Place {
    int texel;
    float share;

    explicit Place(float x)
        : texel(int(std::floor(x - 0.5f))), share(std::round((x - 0.5f - float(texel)) * 256) / 256) {}
};

}  // namespace

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr, int) {
    return *value = cuda_emulated::gpu().texture_edge, cudaSuccess;
}
cudaError_t cudaMalloc3DArray(cudaArray_t* array, const cudaChannelFormatDesc* format, cudaExtent extent, unsigned) {
    const auto longest = std::size_t(cuda_emulated::gpu().texture_edge);
    if (std::max({extent.width, extent.height, extent.depth}) > longest) return cudaErrorInvalidValue;
    void* memory = nullptr;
    const std::size_t texels = extent.width * extent.height * extent.depth;
    const cudaError_t error = cudaMallocAsync(&memory, texels * std::size_t(format->x) / 8, nullptr);
    if (error == cudaSuccess) *array = new EmulatedArray{memory, *format, extent};
    return error;
}
cudaError_t cudaFreeArray(cudaArray_t array) {
    (void)cudaFree(array->memory);
    delete array;
    return cudaSuccess;
}
cudaError_t cudaCreateTextureObject(cudaTextureObject_t* texture, const cudaResourceDesc* resource,
                                    const cudaTextureDesc* lookup, const void*) {
    const EmulatedArray* array = resource->res.array.array;
    const bool is_float = array->format.f == cudaChannelFormatKindFloat;
    if (lookup->filterMode != cudaFilterModeLinear || lookup->addressMode[0] != cudaAddressModeClamp ||
        lookup->normalizedCoords || (lookup->readMode == cudaReadModeNormalizedFloat) == is_float)
        return cudaErrorInvalidValue;
    textures.push_back(array);
    return *texture = textures.size(), cudaSuccess;
}
cudaError_t cudaDestroyTextureObject(cudaTextureObject_t texture) {
    return textures[texture - 1] = nullptr, cudaSuccess;
}

/// A row at a time, each from where it lies when the work is done.
cudaError_t cudaMemcpy3DAsync(const cudaMemcpy3DParms* copy, cudaStream_t stream) {
    const EmulatedArray& to = *copy->dstArray;
    const auto &at = copy->dstPos, &from = copy->srcPos;
    if (from.x || from.y || from.z || at.x + copy->extent.width > to.extent.width ||
        at.y + copy->extent.height > to.extent.height || at.z + copy->extent.depth > to.extent.depth)
        return cudaErrorInvalidValue;
    for (std::size_t z = 0; z < copy->extent.depth; ++z)
        for (std::size_t y = 0; y < copy->extent.height; ++y) {
            const char* row =
                static_cast<const char*>(copy->srcPtr.ptr) + (z * copy->srcPtr.ysize + y) * copy->srcPtr.pitch;
            char* texel = static_cast<char*>(to.memory) + to.index(at.x, at.y + y, at.z + z) * to.texel_bytes();
            cudaMemcpyAsync(texel, row, copy->extent.width * to.texel_bytes(), copy->kind, stream);
        }
    return cudaSuccess;
}

template <>
float tex3D<float>(cudaTextureObject_t texture, float x, float y, float z) {
    const EmulatedArray& array = *textures[texture - 1];
    const Place at[3]{Place(x), Place(y), Place(z)};
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        float weight = 1;
        int texel[3];
        for (int axis = 0; axis < 3; ++axis) {
            const bool next = corner >> axis & 1;
            texel[axis] = at[axis].texel + next;
            weight *= next ? at[axis].share : 1 - at[axis].share;
        }
        sum += weight * array.texel(texel);
    }
    return sum;
}
