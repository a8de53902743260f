// What a kernel reads, told apart from how it is read: so that another memory can hold a copy of it.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace chiaro {

/// What another memory holds and the host has not read yet.
class DeferredDownload {
public:
    explicit DeferredDownload(std::function<void()> fetch) : fetch_(std::move(fetch)) {}
    /// Fetches it at the first call; any thread may ask.
    void fetch() const { std::call_once(once_, fetch_); }

private:
    const std::function<void()> fetch_;
    mutable std::once_flag once_;
};

/// An array in host memory that stays as it is while its owner lives. Without an owner it is one call's own.
struct HostArray {
    std::weak_ptr<const void> owner;
    const void* data = nullptr;
    std::size_t bytes = 0;
    bool is_shared = false;                               ///< has an owner, alive or not
    std::weak_ptr<const DeferredDownload> deferred = {};  ///< what fetches it, where it may not be here yet

    /// A range of anything contiguous (a vector, a VoxelBuffer) that `owner` keeps; without one it is a call's own.
    template <class Range>
    static HostArray of(const std::weak_ptr<const void>& owner, const Range& range) {
        return {owner, range.data(), range.size() * sizeof *range.data(), !owner.expired()};
    }
    /// Before the host reads it.
    void fetch() const {
        if (const auto its = deferred.lock()) its->fetch();
    }
};

class HostArrays {
public:
    template <class Range>
    void add(const std::weak_ptr<const void>& owner, const Range& range) {
        if (range.size()) arrays_.push_back(HostArray::of(owner, range));
    }
    void add(const HostArray& array) { arrays_.push_back(array); }
    /// One call's own.
    template <class Range>
    void add(const Range& range) {
        if (range.size()) arrays_.push_back(HostArray::of({}, range));
    }
    /// The array that holds what is at `pointer`; nullptr: none.
    const HostArray* holding(const void* pointer) const {
        for (const HostArray& array : arrays_) {
            const auto* first = static_cast<const std::byte*>(array.data);
            if (pointer >= first && pointer < first + array.bytes) return &array;
        }
        return nullptr;
    }

    /// Before the host reads any of them.
    void fetch() const {
        for (const HostArray& array : arrays_) array.fetch();
    }

private:
    std::vector<HostArray> arrays_;
};

}  // namespace chiaro
