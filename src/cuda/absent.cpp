// In the place of stream.cpp where there is no nvcc to compile kernels with: there are no GPUs.
#include "cuda/texture.h"

namespace chiaro::cuda {
namespace {

[[noreturn]] void refuse() { throw Error(ErrorCode::internal, "a GPU is used by a build without CUDA"); }

}  // namespace

std::vector<GpuInfo> find_gpus(std::string& why) {
    why = "this build has the CPU only";
    return {};
}

Stream::Stream(GpuInfo, std::shared_ptr<DeviceCache>, bool) : is_optional_(false) { refuse(); }
Stream::~Stream() = default;
void* Stream::allocate(std::size_t) { refuse(); }
void Stream::release(void*) noexcept {}
std::size_t Stream::free_bytes() const { refuse(); }
void Stream::release_at_once(int, void*) noexcept {}
void Stream::upload(void*, const void*, std::size_t) { refuse(); }
void Stream::download(void*, const void*, std::size_t) { refuse(); }
void Stream::copy(void*, const void*, std::size_t) { refuse(); }
void Stream::zero(void*, std::size_t) { refuse(); }
std::byte* Stream::landing(std::size_t) { refuse(); }
void Stream::launched() { refuse(); }
void Stream::settle() noexcept {}
void Stream::wait() { refuse(); }

Texture::Texture(Stream&, Texel texel, std::array<int, 3>) : gpu_(0), texel_(texel) { refuse(); }
Texture::~Texture() = default;
void Texture::copy(Stream&, const Box&) { refuse(); }

}  // namespace chiaro::cuda
