// How the light grid lies in memory for sweeps along each axis: rows along a sweep's planes, so that neighbours in a
// row are neighbours in memory.
#pragma once
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "illumination/cells/grid.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

/// Memory that starts on a cache line; what is not asked to be zero is left as it is found.
template <class T>
struct LineAllocator {
    using value_type = T;
    static constexpr std::align_val_t line{64};

    LineAllocator() = default;
    template <class U>
    LineAllocator(const LineAllocator<U>&) {}
    T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
    void deallocate(T* p, std::size_t) { ::operator delete(p, line); }
    template <class U>
    void construct(U* p) {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Arguments>
    void construct(U* p, Arguments&&... arguments) {
        ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const LineAllocator&) const = default;
};

/// One float a cell, rows padded with zeros to sixteen.
using LatticeField = std::vector<float, LineAllocator<float>>;

/// Rows along x (for sweeps along y and z), or along y (for those along x).
class Lattice {
public:
    Lattice(const std::array<int, 3>& count, bool along_y)
        : count_(count), along_y_(along_y), row_((count[along_y ? 1 : 0] + 15) / 16 * 16) {}

    bool along_y() const { return along_y_; }
    int row() const { return row_; }
    std::size_t size() const { return std::size_t(row_) * (along_y_ ? count_[0] : count_[1]) * count_[2]; }
    std::size_t index(int x, int y, int z) const {
        return along_y_ ? (std::size_t(x) * count_[2] + z) * row_ + y : (std::size_t(z) * count_[1] + y) * row_ + x;
    }
    const std::array<int, 3>& count() const { return count_; }
    LatticeField field() const { return LatticeField(size(), 0.0f); }
    /// Holding anything.
    LatticeField unset_field() const { return LatticeField(size()); }

private:
    std::array<int, 3> count_;
    bool along_y_;
    int row_;
};

/// A slice of constant z from one lattice to the other.
void copy_slice(const Lattice& from, const float* source, const Lattice& to, float* target, int z);

/// A grid's values, x fastest, as a lattice and back.
LatticeField spread(const CellGrid& grid, const float* values, const Lattice& lattice);

}  // namespace chiaro
