// A volume as a GPU's texture units read it.
#pragma once
#include <array>

#include "cuda/stream.h"

namespace chiaro::cuda {

/// What is stored. Whole numbers come out as shares of the largest.
enum class Texel { u8, u16, f32 };

/// A GPU can have no such texture: there is no room for it, or none may be as large.
class NoTexture : public Error {
public:
    explicit NoTexture(const std::string& sentence) : Error(ErrorCode::output, sentence) {}
};

/// Looked up at texel centres (½ beyond whole numbers) it gives the texels, between them what the units interpolate
/// with weights of 8 fractional bits, beyond the outermost these.
class Texture {
public:
    /// A box of texels that lies on the GPU, in rows of `row` texels, `row` of them a slice.
    struct Box {
        const std::byte* from;
        int row;
        std::array<int, 3> to, size;  ///< texels
    };

    /// Throws NoTexture.
    Texture(Stream& stream, Texel texel, std::array<int, 3> size);
    ~Texture();
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    void copy(Stream& stream, const Box& box);
    std::uint64_t handle() const { return handle_; }

private:
    void make(const GpuInfo& gpu, std::array<int, 3> size);

    const int gpu_;
    const Texel texel_;
    void* array_ = nullptr;     ///< a cudaArray_t
    std::uint64_t handle_ = 0;  ///< a cudaTextureObject_t
};

}  // namespace chiaro::cuda
