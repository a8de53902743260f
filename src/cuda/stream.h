// An NVIDIA GPU as the host sees it: its memory, copies to and from it, and an order of work. No type of CUDA's is
// named here, so that everything but stream.cpp and the launch*.cu compiles without it (absent.cpp then says so).
#pragma once
#include <chiaro/device.h>
#include <chiaro/error.h>

#include <mutex>
#include <utility>

/// Before what a launch*.cu defines. Without nvcc these are not compiled: their functions are named, and nothing is
/// there to be called, for there is no device to call it with (absent.cpp).
#ifdef CHIARO_WITHOUT_CUDA
#define CHIARO_LAUNCHER __attribute__((weak))
#else
#define CHIARO_LAUNCHER
#endif

namespace chiaro::cuda {

class DeviceCache;

/// The GPU has too little memory for something; the CPU could still do it.
class OutOfMemory : public Error {
public:
    explicit OutOfMemory(const std::string& sentence) : Error(ErrorCode::output, sentence) {}
};

/// The GPUs, or in `why` the reason why there are none.
std::vector<GpuInfo> find_gpus(std::string& why);

/// Work that is done in order, beside the host's, until the host waits for it. Every call may throw Error{output}: what
/// the driver told (of an earlier call too), OutOfMemory, or that the GPU was lost.
class Stream {
public:
    /// `mirror`: what the streams of one GPU keep there in common. `is_optional`: the GPU was chosen by itself, and
    /// the CPU may take over.
    Stream(GpuInfo gpu, std::shared_ptr<DeviceCache> device_cache, bool is_optional);
    ~Stream();
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;

    const GpuInfo& gpu() const { return gpu_; }
    const std::shared_ptr<DeviceCache>& device_cache() const { return device_cache_; }
    void* handle() const { return handle_; }  ///< a cudaStream_t

    void* allocate(std::size_t bytes);  ///< for what is done later on this stream
    void release(void* memory) noexcept;
    std::size_t free_bytes() const;                                ///< bytes that are free now
    void upload(void* to, const void* from, std::size_t bytes);    ///< `from` stays as it is until the host has waited
    void download(void* to, const void* from, std::size_t bytes);  ///< `to` is there when the host has waited
    void copy(void* to, const void* from, std::size_t bytes);      ///< on the GPU
    void zero(void* memory, std::size_t bytes);
    /// Page-locked memory of the host that the GPU writes to at full speed: the same at each call, until it must grow.
    std::byte* landing(std::size_t bytes);
    /// Waits until `bytes` have come to `to`, any memory: by the landing, or where there is no room for that straight.
    void fetch(void* to, const void* from, std::size_t bytes);
    void launched();  ///< tells what went wrong in starting a kernel
    void wait();
    void settle() noexcept;  ///< waits, whatever happened: before what is still read or written goes

    /// Of any stream's or of none, at any time.
    static void release_at_once(int gpu, void* memory) noexcept;

    bool is_optional() const { return is_optional_; }
    void give_up(const OutOfMemory& error);  ///< throws it again where the GPU must do the work
    std::string given_up() const;            ///< why; empty: it has not
    void do_without(
        const std::string& sentence);  ///< tells what the GPU cannot do, while it does the rest; empty: nothing
    std::string note() const;          ///< what a user should know of all this; empty: nothing

private:
    void use() const;

    const GpuInfo gpu_;
    const std::shared_ptr<DeviceCache> device_cache_;
    const bool is_optional_;
    void* handle_ = nullptr;
    std::mutex landing_mutex_;  ///< sessions that share voxels may share the stream of whoever brought them
    std::byte* landing_ = nullptr;
    std::size_t landing_bytes_ = 0;
    mutable std::mutex mutex_;  ///< of these:
    std::string given_up_, done_without_;
};

/// Whether the device has a GPU that has not given up.
inline bool works(const Device& device) { return device.stream && device.stream->given_up().empty(); }

/// Has the GPU do the work; false where it was chosen by itself and has no room: it has given up, or does now.
template <class Work>
bool try_gpu(Stream& stream, const Work& work) {
    if (!stream.given_up().empty()) return false;
    try {
        work();
        return true;
    } catch (const OutOfMemory& error) {
        stream.give_up(error);
        return false;
    }
}
/// False too where the device has none.
template <class Work>
bool try_gpu(const Device& device, const Work& work) {
    return device.stream && try_gpu(*device.stream, work);
}

/// Nothing that is still copied goes before the copy is done, also when something fails.
struct SyncOnExit {
    Stream& stream;
    ~SyncOnExit() { stream.settle(); }
};

/// An owned array on a GPU, for the work of one stream.
template <class T>
class Array {
public:
    Array(Stream& stream, std::size_t count)
        : stream_(&stream), data_(static_cast<T*>(stream.allocate(count * sizeof(T)))), count_(count) {}
    Array(Array&& other) noexcept
        : stream_(other.stream_), data_(std::exchange(other.data_, nullptr)), count_(other.count_) {}
    Array& operator=(Array&&) = delete;
    ~Array() {
        if (data_) stream_->release(data_);
    }

    T* data() const { return data_; }  ///< not for the host to read
    std::size_t size() const { return count_; }
    void zero() { stream_->zero(data_, count_ * sizeof(T)); }

private:
    Stream* stream_;
    T* data_;
    std::size_t count_;
};

}  // namespace chiaro::cuda
