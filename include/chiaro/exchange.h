// What processes that share one volume tell each other.
#pragma once
#include <chiaro/export.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro {

/// The ranks that share a volume, each with a block of it (Placement). All functions are collective: every rank calls
/// the same ones in the same order, with as many numbers, and waits for the others. This one is of one rank; MPI's is
/// the caller's (docs/cluster.md). All ranks are machines of one kind: numbers go as they lie in memory.
class CHIARO_EXPORT Exchange {
public:
    Exchange() = default;
    virtual ~Exchange();
    Exchange(const Exchange&) = delete;
    Exchange& operator=(const Exchange&) = delete;

    virtual int rank() const { return 0; }
    virtual int size() const { return 1; }
    /// Every number becomes the sum, the largest or the smallest of all ranks', by number. Sums of floats may be
    /// rounded in any order.
    virtual void sum(std::span<std::int64_t>) {}
    virtual void sum(std::span<float>) {}
    virtual void largest(std::span<float>) {}
    virtual void smallest(std::span<float>) {}
    /// The blocks of all ranks, by rank; each may have a length of its own.
    virtual std::vector<std::vector<std::byte>> gather(std::span<const std::byte> mine) {
        return {{mine.begin(), mine.end()}};
    }
    /// All ranks' become what rank 0 has.
    virtual void broadcast(std::span<std::byte>) {}
    /// Whether all ranks say so.
    bool agree(bool yes) {
        std::int64_t against = yes ? 0 : 1;
        sum({&against, 1});
        return against == 0;
    }
};

}  // namespace chiaro
