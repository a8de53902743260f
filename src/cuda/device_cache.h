// What a GPU keeps of host memory: every array is copied there once, and stays as long as its owner on the host does.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

#include "core/host_array.h"
#include "cuda/stream.h"
#include "cuda/texture.h"

namespace chiaro::cuda {

/// The copies that the streams of a GPU share. Arrays are known by owner and address: an owner's arrays never change,
/// and the address of one that has gone is not taken for its own (weak pointers tell owners apart for ever).
class DeviceCache {
public:
    explicit DeviceCache(int gpu) : gpu_(gpu) {}
    ~DeviceCache();
    DeviceCache(const DeviceCache&) = delete;
    DeviceCache& operator=(const DeviceCache&) = delete;

    /// Where the array lies on the GPU; waits for the copy where there was none.
    const std::byte* of(const HostArray& array, Stream& stream);
    /// The array was made on the GPU, at `made`: a copy from there is kept, and none comes from the host.
    void keep(const HostArray& array, const void* made, Stream& stream);
    /// The texture of an array, which `make` makes on the stream when it is first asked for; waits for that.
    std::uint64_t texture(const HostArray& array, Stream& stream,
                          const std::function<std::unique_ptr<Texture>()>& make);
    std::uint64_t copied_bytes() const { return copied_bytes_; }  ///< so far
    std::size_t held_bytes() const;

private:
    struct Copy {
        HostArray of;
        std::byte* memory;
    };
    template <class Fill>
    const std::byte* add(const HostArray& array, Stream& stream, const Fill& fill);
    /// nullptr: none.
    const std::byte* kept(const HostArray& array) const;
    void let_go_of_orphans(Stream& stream);

    const int gpu_;
    mutable std::mutex mutex_;
    std::vector<Copy> copies_;
    std::vector<std::pair<HostArray, std::unique_ptr<Texture>>> textures_;
    std::atomic<std::uint64_t> copied_bytes_{0};
};

/// The GPU keeps what was `made` there as its copy of the array; what is returned fetches it to `to`.
std::shared_ptr<const DeferredDownload> keep_resident(const std::shared_ptr<Stream>& stream, const HostArray& array,
                                                      const void* made, void* to);

/// One call's kernels: turns their pointers into host arrays into pointers to the GPU's copies of those.
class Views {
public:
    Views(Stream& stream, HostArrays arrays) : stream_(stream), arrays_(std::move(arrays)) {}
    ~Views() {
        if (!own_.empty()) stream_.settle();  // a call's own arrays go with it
    }
    Views(const Views&) = delete;
    Views& operator=(const Views&) = delete;

    /// Null stays null. Throws Error{internal} for a pointer into none of the arrays.
    template <class... T>
    void to_device_pointers(const T*&... pointers) {
        ((pointers = static_cast<const T*>(static_cast<const void*>(on_gpu(pointers)))), ...);
    }

private:
    const std::byte* on_gpu(const void* pointer);

    struct Own {
        const HostArray* of;
        Array<std::byte> memory;
    };
    Stream& stream_;
    const HostArrays arrays_;
    std::vector<Own> own_;
};

}  // namespace chiaro::cuda
