// Ranks as threads of one process: an Exchange among them, and volumes cut into blocks.
#pragma once
#include <chiaro/exchange.h>
#include <chiaro/lighting.h>
#include <chiaro/volume.h>

#include <barrier>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <thread>

namespace chiaro::testing {

/// What the ranks have in common: each lays down where its numbers are, and all read them when all have.
struct RankGroup {
    explicit RankGroup(int size) : all(std::size_t(size)), meeting(size) {}
    std::vector<std::span<const std::byte>> all;
    std::barrier<> meeting;
};

class ThreadExchange : public Exchange {
public:
    ThreadExchange(std::shared_ptr<RankGroup> group, int rank) : group_(std::move(group)), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return int(group_->all.size()); }
    std::vector<std::vector<std::byte>> gather(std::span<const std::byte> mine) override {
        sent += mine.size();
        group_->all[std::size_t(rank_)] = mine;
        group_->meeting.arrive_and_wait();
        std::vector<std::vector<std::byte>> blocks;
        for (const auto& block : group_->all) blocks.emplace_back(block.begin(), block.end());
        group_->meeting.arrive_and_wait();
        return blocks;
    }
    void sum(std::span<std::int64_t> numbers) override { reduce(numbers, std::plus<>()); }
    void sum(std::span<float> numbers) override { reduce(numbers, std::plus<>()); }
    void largest(std::span<float> numbers) override {
        reduce(numbers, [](float a, float b) { return std::max(a, b); });
    }
    void smallest(std::span<float> numbers) override {
        reduce(numbers, [](float a, float b) { return std::min(a, b); });
    }
    void broadcast(std::span<std::byte> bytes) override {
        const auto blocks = gather(bytes);
        std::memcpy(bytes.data(), blocks[0].data(), bytes.size());
    }

    std::size_t sent = 0;  ///< bytes

private:
    template <class T, class Join>
    void reduce(std::span<T> numbers, const Join& join) {
        const auto blocks = gather(std::as_bytes(numbers));
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            T joined = reinterpret_cast<const T*>(blocks[0].data())[i];
            for (std::size_t r = 1; r < blocks.size(); ++r)
                joined = join(joined, reinterpret_cast<const T*>(blocks[r].data())[i]);
            numbers[i] = joined;
        }
    }

    std::shared_ptr<RankGroup> group_;
    int rank_;
};

/// work(exchange) on so many ranks at a time; the first rank's exception is thrown when all have ended.
inline void on_ranks(int size, const std::function<void(std::shared_ptr<ThreadExchange>)>& work) {
    const auto group = std::make_shared<RankGroup>(size);
    std::vector<std::exception_ptr> errors(std::size_t(size), nullptr);
    std::vector<std::thread> threads;
    for (int rank = 0; rank < size; ++rank)
        threads.emplace_back([&, rank] {
            try {
                work(std::make_shared<ThreadExchange>(group, rank));
            } catch (...) {
                errors[std::size_t(rank)] = std::current_exception();
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

/// Half-open.
struct OwnVoxels {
    std::array<int, 3> first, end;
};

/// A volume cut by planes, one after the other: first all of it is one block; each cut parts the block of its number
/// before voxel `at` of an axis, and the part behind becomes the last block.
struct Cut {
    int block, axis, at;
};
inline std::vector<OwnVoxels> cut_up(const std::array<int, 3>& whole, const std::vector<Cut>& cuts) {
    std::vector<OwnVoxels> blocks{{{0, 0, 0}, whole}};
    for (const auto& [block, axis, at] : cuts) {
        OwnVoxels behind = blocks[std::size_t(block)];
        behind.first[std::size_t(axis)] = blocks[std::size_t(block)].end[std::size_t(axis)] = at;
        blocks.push_back(behind);
    }
    return blocks;
}
/// Voxels on each side that light by a method needs.
inline int ghosts_of(Method method) { return method == Method::spao ? 9 : 8; }

/// The block of a volume that owns these voxels, with so many ghosts on each side.
inline Volume block_of(const Volume& whole, const OwnVoxels& own, int ghosts) {
    Placement place{whole.dimensions, {}, own.first, own.end};
    Volume block;
    for (std::size_t a = 0; a < 3; ++a) {
        place.first[a] = std::max(own.first[a] - ghosts, 0);
        block.dimensions[a] = std::min(own.end[a] + ghosts, whole.dimensions[a]) - place.first[a];
    }
    block.type = whole.type, block.slope = whole.slope, block.intercept = whole.intercept;
    block.geometry = whole.geometry, block.source = whole.source;
    const std::size_t voxel = size_of(whole.type), row = std::size_t(block.dimensions[0]) * voxel;
    block.voxels = VoxelBuffer(block.voxel_count() * voxel);
    std::byte* to = block.voxels.data();
    for (int z = 0; z < block.dimensions[2]; ++z)
        for (int y = 0; y < block.dimensions[1]; ++y, to += row) {
            const std::size_t from =
                (std::size_t(place.first[2] + z) * std::size_t(whole.dimensions[1]) + std::size_t(place.first[1] + y)) *
                    std::size_t(whole.dimensions[0]) +
                std::size_t(place.first[0]);
            std::memcpy(to, whole.voxels.data() + from * voxel, row);
        }
    block.placement = place;
    return block;
}

}  // namespace chiaro::testing
