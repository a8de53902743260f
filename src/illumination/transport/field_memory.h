// Where fields of the light grid live: in large pages, kept from one solve to the next.
#pragma once
#include <cstddef>
#include <new>
#include <utility>

namespace chiaro {

/// Memory on a cache line, from slabs in large pages where `bytes` is much. Slabs of which nothing is used are kept
/// for the next solve, 64 MiB of them at most: fresh pages cost as much as half a sweep. Throws Error{output} when
/// there is none. May be called from any thread.
void* take_field_memory(std::size_t bytes);
void give_field_memory(void* memory, std::size_t bytes) noexcept;

/// What is not asked to be zero is left as it is found.
template <class T>
struct FieldAllocator {
    using value_type = T;

    FieldAllocator() = default;
    template <class U>
    FieldAllocator(const FieldAllocator<U>&) {}
    T* allocate(std::size_t n) { return static_cast<T*>(take_field_memory(n * sizeof(T))); }
    void deallocate(T* p, std::size_t n) { give_field_memory(p, n * sizeof(T)); }
    template <class U>
    void construct(U* p) {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Arguments>
    void construct(U* p, Arguments&&... arguments) {
        ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const FieldAllocator&) const = default;
};

}  // namespace chiaro
