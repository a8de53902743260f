// One level of a source of bricks, of which as many are in memory as rays have asked for and a budget allows.
#pragma once
#include <chiaro/brick_source.h>

#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "volume/level_pages.h"

namespace chiaro {

/// What of a brick a medium shows.
struct BrickLooks {
    /// From a range of stored values per cell to the cells' codes; false where none is occupied.
    std::function<bool(const CellRanges& ranges, std::uint8_t* codes)> code;
    /// Whether a cell of such values would be occupied.
    std::function<bool(float low, float high)> shows;
    /// Bricks that were read stay though they are empty, for what looks at voxels there.
    bool keep_empty = false;
};

class PagedLevel {
public:
    /// Bytes that a brick takes while it is there.
    static std::size_t bytes_of_brick(VoxelType stored);
    /// ... and one that is not.
    static constexpr std::size_t bytes_of_entry = sizeof(std::int32_t) + 1;

    /// Most bricks that there can be room for: kernels number voxels in memory by 32 bits.
    static std::int32_t max_room(const DeviceVolume& coarse);

    /// Room for so many bricks, of which none is there yet. `coarse`: another level of the source as a whole.
    PagedLevel(std::shared_ptr<const BrickSource> source, int level, const DeviceVolume& coarse, std::int32_t room);

    int level() const { return level_; }
    const DeviceVolume& volume() const { return volume_; }
    const LevelPages& pages() const { return *pages_; }

    /// From now on `looks` tell what is empty. Bricks that are absent are, where `may_show` says that nothing shows,
    /// and where they were read before and the range of their values says so.
    void classify(BrickLooks looks, const std::function<bool(std::int64_t brick)>& may_show);

    void forget_seen();
    /// Bricks that were seen and are absent, in order.
    std::vector<std::int64_t> missing() const;
    /// Reads bricks, letting go of others that were not seen. False where there is no room for all. Which are there in
    /// the end depends on no number of threads. Those that cannot be read are left out, and told in `faults`. Throws
    /// Error{interrupted} when cancelled; what was read by then stays. Reported as "bricks".
    bool read(const std::vector<std::int64_t>& bricks, Progress& progress);

    std::size_t bricks_read() const { return bricks_read_; }  ///< since it was made
    std::size_t bricks_there() const;
    const std::vector<std::string>& faults() const { return faults_; }  ///< the first few, a sentence each
    std::size_t bricks_lost() const { return lost_; }                   ///< that cannot be read

private:
    std::array<int, 3> place_of(std::int64_t brick) const;
    std::vector<std::size_t> by_pieces(std::span<const std::int64_t> bricks) const;
    void fill(std::int64_t brick, std::int32_t slot);
    bool code(std::int32_t slot);
    void take_free();
    CellRanges ranges_of(std::int32_t slot) const;

    std::shared_ptr<const BrickSource> source_;
    int level_;
    std::shared_ptr<DeviceVolume::Data> data_;
    std::shared_ptr<LevelPages> pages_;
    DeviceVolume volume_;
    VoxelBuffer ranges_;                  // [slot][low, high][cell], floats
    std::vector<std::int64_t> brick_of_;  // each slot's; -1: free
    std::vector<std::int32_t> free_;
    std::vector<std::uint8_t> is_lost_;
    BrickLooks looks_;
    std::unordered_map<std::int64_t, std::array<float, 2>> let_go_;  // read and found empty: the range of their values
    std::size_t bricks_read_ = 0, lost_ = 0;
    std::vector<std::string> faults_;
};

}  // namespace chiaro
