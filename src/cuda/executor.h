// Where the steps of a method are done, so that they are written once: on the threads of the CPU, or on a GPU. Both
// have arrays, for_each(items, kernel) and synchronize(); the kernels are the same source, so the results are the same
// bits. What a step reads and writes lies in that memory: pointers into host arrays are exchanged first.
#pragma once
#include <array>
#include <list>
#include <vector>

#include "core/threads.h"
#include "cuda/device_cache.h"
#include "cuda/each_node.h"
#include "cuda/run.h"

namespace chiaro {

/// Steps on the threads of the CPU. `progress`: none for passes of milliseconds.
class CpuExecutor {
public:
    static constexpr bool is_gpu = false;
    CpuExecutor(int threads, Progress* progress) : threads_(threads), progress_(progress) {}

    /// `count` numbers, all 0.
    template <class T>
    std::vector<T> zeros(std::size_t count) const {
        return std::vector<T>(count);
    }
    /// `count` numbers that a kernel will set.
    template <class T>
    std::vector<T> array(std::size_t count) const {
        return std::vector<T>(count);
    }
    /// A contiguous range of the caller's, as kernels read it.
    template <class Range>
    auto input(const Range& range) {
        return range.data();
    }
    /// The same of a range that stays as it is while its owner lives, and is copied once.
    template <class Range>
    auto kept(const std::weak_ptr<const void>&, const Range& range) const {
        return range.data();
    }
    /// Values that the host and a GPU both know, as kernels read them.
    template <class Values>
    auto values(const Values& values) const {
        return values.data();
    }
    template <class T, class Buffer>
    const T* values(const Buffer& buffer) const {
        return reinterpret_cast<const T*>(buffer.data());
    }
    /// Exchanges pointers into `arrays` for those of this memory's copies.
    template <class... T>
    void exchange(const HostArrays&, const T*&...) {}

    /// A buffer whose values a kernel makes: data() is where, all 0 on a GPU; keep() when they are all there.
    template <class T, class Buffer>
    struct Output {
        T* to;
        T* data() const { return to; }
        void keep() const {}
    };
    template <class T, class Buffer>
    Output<T, Buffer> output(Buffer& buffer) const {
        return {reinterpret_cast<T*>(buffer.data())};
    }
    /// An array of this memory moves into a vector of the host.
    template <class T>
    void fetch(std::vector<T>& to, std::vector<T>& from) const {
        to = std::move(from);
    }

    /// kernel(i) for each i of [0, count), `grain` of them at a time. Throws Error{interrupted} where it reports.
    template <class Kernel>
    void for_each(std::int64_t count, const Kernel& kernel, std::string_view stage = {},
                  std::int64_t grain = 4096) const {
        const auto body = [&](std::int64_t first, std::int64_t end) {
            for (std::int64_t i = first; i < end; ++i) kernel(i);
        };
        if (!progress_ || stage.empty()) return parallel_for(threads_, count, grain, body);
        parallel_for(threads_, count, grain, stage, *progress_, body);
        progress_->check();
    }
    /// kernel(node, x, y, z) of a grid's nodes, x fastest: by rows, without a division for each.
    template <class Kernel>
    void for_each_node(const std::array<int, 3>& count, const Kernel& kernel, std::string_view stage = {},
                       std::int64_t rows = 4) const {
        const auto of_row = [&](std::int64_t row) {
            const std::int32_t y = std::int32_t(row % count[1]), z = std::int32_t(row / count[1]);
            for (std::int32_t x = 0; x < count[0]; ++x) kernel(row * count[0] + x, x, y, z);
        };
        for_each(std::int64_t(count[1]) * count[2], of_row, stage, rows);
    }
    void synchronize() const {}

private:
    const int threads_;
    Progress* const progress_;
};

/// The same on the stream of a GPU, which works beside the host until synchronize() or fetch().
class GpuExecutor {
public:
    static constexpr bool is_gpu = true;
    explicit GpuExecutor(std::shared_ptr<cuda::Stream> stream, Progress* progress = nullptr)
        : stream_(std::move(stream)), progress_(progress) {}
    GpuExecutor(const GpuExecutor&) = delete;
    GpuExecutor& operator=(const GpuExecutor&) = delete;

    cuda::Stream& stream() const { return *stream_; }

    template <class T>
    cuda::Array<T> zeros(std::size_t count) const {
        cuda::Array<T> array(*stream_, count);
        array.zero();
        return array;
    }
    template <class T>
    cuda::Array<T> array(std::size_t count) const {
        return {*stream_, count};
    }
    template <class Range>
    auto input(const Range& range) {
        auto pointer = range.data();
        HostArrays arrays;
        arrays.add(range);
        if (range.size() > 0) exchange(arrays, pointer);
        return pointer;
    }
    template <class Range>
    auto kept(const std::weak_ptr<const void>& owner, const Range& range) const {
        const std::byte* copy = stream_->device_cache()->of(HostArray::of(owner, range), *stream_);
        return reinterpret_cast<decltype(range.data())>(copy);
    }
    template <class Values>
    auto values(const Values& values) const {
        return values.on_gpu(*stream_);
    }
    template <class T, class Buffer>
    const T* values(const Buffer& buffer) const {
        return reinterpret_cast<const T*>(buffer.on_gpu(*stream_));
    }
    template <class... T>
    void exchange(const HostArrays& arrays, const T*&... pointers) {
        inputs_.emplace_back(*stream_, arrays).to_device_pointers(pointers...);
    }

    template <class T, class Buffer>
    struct Output {
        const std::shared_ptr<cuda::Stream>& stream;
        Buffer& buffer;
        cuda::Array<T> made;
        T* data() const { return made.data(); }
        void keep() const { buffer.keep(stream, made.data()); }
    };
    template <class T, class Buffer>
    Output<T, Buffer> output(Buffer& buffer) const {
        return {stream_, buffer, zeros<T>(buffer.size() / sizeof(T))};
    }
    template <class T>
    void fetch(std::vector<T>& to, const cuda::Array<T>& from) const {
        to.resize(from.size());
        stream_->fetch(to.data(), from.data(), from.size() * sizeof(T));
    }

    template <class Kernel>
    void for_each(std::int64_t count, const Kernel& kernel, std::string_view = {}, std::int64_t = 0) const {
        kernel::run_on_gpu(*stream_, count, kernel);
        if (progress_) progress_->check();
    }
    template <class Kernel>
    void for_each_node(const std::array<int, 3>& count, const Kernel& kernel, std::string_view = {},
                       std::int64_t = 0) const {
        for_each(std::int64_t(count[0]) * count[1] * count[2], kernel::EachNode<Kernel>{kernel, count[0], count[1]});
    }
    void synchronize() const { stream_->wait(); }

private:
    const std::shared_ptr<cuda::Stream> stream_;
    Progress* const progress_;
    std::list<cuda::Views> inputs_;  ///< which wait, before they go, until all has been copied
};

/// steps(executor) on the device's GPU, or on the CPU where there is none or it has no memory left: then from the first
/// step on, so steps keep their results last.
template <class Steps>
void run_steps(const Device& device, Progress* progress, const Steps& steps) {
    const auto on_gpu = [&] {
        GpuExecutor executor(device.stream, progress);
        steps(executor);
    };
    if (cuda::try_gpu(device, on_gpu)) return;
    CpuExecutor executor(device.threads, progress);
    steps(executor);
}

}  // namespace chiaro
