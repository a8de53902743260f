// Devices with a GPU.
#include <chiaro/device.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "cuda/device_cache.h"
#include "cuda/stream.h"

namespace chiaro {
namespace {

constexpr std::size_t least_free_bytes = std::size_t(1) << 30;

Device with_gpu(const Device& host, const GpuInfo& gpu, bool is_optional) {
    Device device = host;
    device.stream = std::make_shared<cuda::Stream>(gpu, std::make_shared<cuda::DeviceCache>(gpu.index), is_optional);
    return device;
}

}  // namespace

namespace cuda {

void Stream::fetch(void* to, const void* from, std::size_t bytes) {
    const std::lock_guard lock(landing_mutex_);
    std::byte* landed = nullptr;
    try {
        landed = landing(bytes);
    } catch (const OutOfMemory&) {
        landed = static_cast<std::byte*>(to);
    }
    download(landed, from, bytes);
    wait();
    if (landed != to) std::memcpy(to, landed, bytes);
}

void Stream::give_up(const OutOfMemory& error) {
    if (!is_optional_) throw error;
    const std::lock_guard lock(mutex_);
    given_up_ = std::string(error.what()) + "; the CPU does the work";
}

std::string Stream::given_up() const {
    const std::lock_guard lock(mutex_);
    return given_up_;
}

void Stream::do_without(const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    done_without_ = sentence;
}

std::string Stream::note() const {
    const std::lock_guard lock(mutex_);
    return given_up_.empty() ? done_without_ : given_up_;
}

}  // namespace cuda

std::string Device::name() const { return stream ? fmt::format("cuda:{}", stream->gpu().index) : "cpu"; }

Device Device::with_own_stream() const {
    Device device = *this;
    if (stream)
        device.stream = std::make_shared<cuda::Stream>(stream->gpu(), stream->device_cache(), stream->is_optional());
    return device;
}

std::string Device::note() const { return stream ? stream->note() : ""; }

Device Device::cuda(int index, const Device& host) {
    std::string why;
    const auto gpus = cuda::find_gpus(why);
    if (gpus.empty()) throw Error(ErrorCode::output, fmt::format("--device cuda: {}", why));
    const auto gpu = std::find_if(gpus.begin(), gpus.end(), [&](const auto& each) { return each.index == index; });
    if (gpu == gpus.end())
        throw Error(ErrorCode::output,
                    fmt::format("--device cuda:{}: there is no such GPU (0 to {})", index, gpus.back().index));
    return with_gpu(host, *gpu, false);
}

std::vector<GpuInfo> list_gpus() {
    std::string why;
    return cuda::find_gpus(why);
}

DeviceChoice choose_device(const Device& host) {
    const auto gpus = list_gpus();
    if (gpus.empty()) return {host, ""};
    const auto gpu = std::max_element(gpus.begin(), gpus.end(),
                                      [](const auto& a, const auto& b) { return a.free_bytes < b.free_bytes; });
    const std::string name = fmt::format("cuda:{} ({})", gpu->index, gpu->name);
    if (gpu->free_bytes < least_free_bytes)
        return {host, fmt::format("{} has {} MiB free, too few to be chosen by itself: the CPU does the work", name,
                                  gpu->free_bytes >> 20)};
    try {
        return {with_gpu(host, *gpu, true), fmt::format("on {}, {} MiB free", name, gpu->free_bytes >> 20)};
    } catch (const Error& error) {
        return {host, fmt::format("{}: the CPU does the work", error.what())};
    }
}

}  // namespace chiaro
